#pragma once

#include <selkie/scene/read_scene.h>

#include <deal.II/base/mpi.h>

#include <unistd.h>

#include <fstream>
#include <string>

/// Scenes for unit tests, as text, read by the program's own reader.
namespace small_scenes
{
  /// A block of water (jittered points) next to a block of rubber on it, in a
  /// box with slip walls; sheared by an initial velocity.
  inline std::string
  fluid_on_solid()
  {
    return R"(
set Title     = fluid on solid
set Dimension = 2
set Effects   = inertia, gravity, viscosity
subsection Domain
  set Lower corner = 0, 0
  set Upper corner = 0.5, 0.8
  set Cells        = 5, 8
end
subsection Bodies
  set Names = water, bed
  subsection water
    set Law    = newtonian fluid
    set Shape  = box(0, 0.3, 0.5, 0.6)
    set Jitter = 0.2
    set Initial velocity = 0.3*y*x; 0.2*x
    subsection Law parameters
      set Density      = 1000
      set Bulk modulus = 2e5
      set Viscosity    = 5
    end
  end
  subsection bed
    set Law   = neo hookean
    set Shape = box(0, 0, 0.5, 0.3)
    set Initial velocity = 0.3*y; 0
    subsection Law parameters
      set Density       = 1200
      set Young modulus = 1e5
      set Poisson ratio = 0.3
    end
  end
end
subsection Gravity
  set Acceleration = 0, -9.81
end
subsection Inertia
  set Newmark beta  = 0.3025
  set Newmark gamma = 0.6
end
subsection Time
  set End time = 0.1
  set Step     = 2e-3
end
)";
  }

  /// Water on two blocks side by side, the left one of rubber with a pressure
  /// of its own, the right one a solid without; all moving, in a box with slip
  /// walls.
  inline std::string
  water_on_rubber(const unsigned int dim)
  {
    const bool deep = dim == 3;
    const auto box  = [deep](const std::string &lower,
                            const std::string &upper) {
      return "box(" + lower + (deep ? ", 0, " : ", ") + upper +
             (deep ? ", 0.3)" : ")");
    };
    const std::string zero = deep ? "; 0.1*x\n" : "\n";
    return "set Dimension = " + std::to_string(dim) +
           "\nset Effects = inertia, viscosity, mixed pressure"
           "\nsubsection Domain"
           "\n  set Lower corner = " +
           (deep ? "0, 0, 0" : "0, 0") +
           "\n  set Upper corner = " + (deep ? "0.4, 0.6, 0.3" : "0.4, 0.6") +
           "\n  set Cells        = " + (deep ? "4, 6, 3" : "4, 6") +
           "\nend"
           "\nsubsection Bodies"
           "\n  set Names = water, rubber, steel"
           "\n  subsection water"
           "\n    set Law    = newtonian fluid"
           "\n    set Shape  = " +
           box("0, 0.2", "0.4, 0.5") +
           "\n    set Jitter = 0.2"
           "\n    set Initial velocity = 0.3*y*x; 0.2*x" +
           zero +
           "    subsection Law parameters"
           "\n      set Bulk modulus = 2e5"
           "\n      set Viscosity    = 5"
           "\n    end"
           "\n  end"
           "\n  subsection rubber"
           "\n    set Law   = isochoric neo hookean"
           "\n    set Shape = " +
           box("0, 0", "0.2, 0.2") + "\n    set Initial velocity = 0.3*y; 0" +
           zero +
           "    subsection Law parameters"
           "\n      set Young modulus = 1e5"
           "\n      set Poisson ratio = 0.4999"
           "\n    end"
           "\n  end"
           "\n  subsection steel"
           "\n    set Law   = neo hookean"
           "\n    set Shape = " +
           box("0.2, 0", "0.4, 0.2") + "\n    set Initial velocity = 0.3*y; 0" +
           zero +
           "    subsection Law parameters"
           "\n      set Young modulus = 1e6"
           "\n    end"
           "\n  end"
           "\nend"
           "\nsubsection Inertia"
           "\n  set Newmark beta  = 0.3025"
           "\n  set Newmark gamma = 0.6"
           "\nend"
           "\nsubsection Time"
           "\n  set End time = 0.1"
           "\n  set Step     = 2e-3"
           "\nend\n";
  }

  /// A free elastic square in the middle of an empty box.
  inline std::string
  free_block()
  {
    return R"(
set Title     = free block
set Dimension = 2
set Effects   = inertia
subsection Domain
  set Lower corner = 0, 0
  set Upper corner = 1, 1
  set Cells        = 10, 10
  subsection Walls
    set left   = free
    set right  = free
    set bottom = free
    set top    = free
  end
end
subsection Bodies
  set Names = block
  subsection block
    set Law   = neo hookean
    set Shape = box(0.3, 0.3, 0.7, 0.7)
    set Initial velocity = 0.3; 0.1
    subsection Law parameters
      set Density       = 1000
      set Young modulus = 1e6
      set Poisson ratio = 0.3
    end
  end
end
subsection Time
  set End time = 0.02
  set Step     = 1e-3
end
)";
  }

  /// Two elastic blocks on an oblique line, with a gap (m) between faces across
  /// y; the lower one flies towards the upper one at a speed (m/s).
  inline std::string
  two_blocks(const double gap, const double speed = 20.)
  {
    std::string text = free_block();
    text.replace(text.find("= inertia"), 9, "= inertia, contact");
    const auto from = text.find("  set Names = block");
    const auto to   = text.find("subsection Time");
    const auto body = [](const std::string &name,
                         const std::string &shape,
                         const std::string &velocity) {
      return "  subsection " + name +
             "\n    set Law   = neo hookean\n    set Shape = " + shape +
             "\n    set Initial velocity = " + velocity + R"(
    subsection Law parameters
      set Density       = 1000
      set Young modulus = 1e6
      set Poisson ratio = 0.3
    end
  end
)";
    };
    const std::string middle = std::to_string(0.5 + gap);
    text.replace(from,
                 to - from,
                 "  set Names = lower, upper\n" +
                   body("lower",
                        "box(0.3, 0.2, 0.7, 0.5)",
                        "0.2; " + std::to_string(speed)) +
                   body("upper", "box(0.4, " + middle + ", 0.8, 0.8)", "0; 0") +
                   "end\n");
    return text;
  }

  /// Reads a scene from text. Collective.
  template <int dim>
  selkie::Scene<dim>
  read(const std::string &text, const std::vector<std::string> &overrides = {})
  {
    const MPI_Comm    comm = MPI_COMM_WORLD;
    const std::string file = dealii::Utilities::MPI::broadcast(
      comm, "/tmp/selkie_test_" + std::to_string(getpid()) + ".prm");
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      std::ofstream(file) << text;
    MPI_Barrier(comm);
    auto scene = selkie::read_scene<dim>(file, overrides);
    MPI_Barrier(comm);
    if (dealii::Utilities::MPI::this_mpi_process(comm) == 0)
      unlink(file.c_str());
    return scene;
  }
} // namespace small_scenes
