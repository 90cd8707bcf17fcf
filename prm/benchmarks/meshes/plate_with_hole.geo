// A quarter of a plate (1 m by 1 m) with a hole of radius 0.05 m at the corner;
// 24 by 20 quadrilaterals, finer towards the hole. Makes plate_with_hole.msh:
//   gmsh -2 -format msh22 plate_with_hole.geo
a = 0.05;
Point(1) = {0, 0, 0};
Point(2) = {a, 0, 0};
Point(3) = {1, 0, 0};
Point(4) = {1, 1, 0};
Point(5) = {0, 1, 0};
Point(6) = {0, a, 0};
Point(7) = {a / Sqrt(2), a / Sqrt(2), 0};
Circle(1) = {2, 1, 7};
Circle(2) = {7, 1, 6};
Line(3) = {2, 3};
Line(4) = {7, 4};
Line(5) = {6, 5};
Line(6) = {3, 4};
Line(7) = {4, 5};
Transfinite Line{1, 2, 6, 7} = 13;
Transfinite Line{3, 4, 5} = 21 Using Progression 1.2;
Line Loop(1) = {3, 6, -4, -1};
Plane Surface(1) = {1};
Line Loop(2) = {4, 7, -5, -2};
Plane Surface(2) = {2};
Transfinite Surface{1, 2};
Recombine Surface{1, 2};
// Only what is in a physical group is written: without the lines between the
// two surfaces, which deal.II would take for a boundary.
Physical Surface(1) = {1, 2};
