#include <selkie/drivers/simulation.h>

#include <iostream>

// A stand-in until the simulation is written.
namespace selkie
{
  template <int dim>
  int
  run_scene(const Scene<dim> &scene, const MPI_Comm comm)
  {
    print_plan(scene, comm);
    return 0;
  }


  template <int dim>
  void
  print_plan(const Scene<dim> &scene, const MPI_Comm comm)
  {
    if (dealii::Utilities::MPI::this_mpi_process(comm) != 0)
      return;
    std::cout << scene.file << ": the scene is valid. Effects:";
    for (const auto &effect : scene.effects)
      std::cout << (effect == scene.effects[0] ? " " : ", ") << effect;
    std::cout << std::endl;
  }


  template int
  run_scene(const Scene<2> &, const MPI_Comm);
  template int
  run_scene(const Scene<3> &, const MPI_Comm);
  template void
  print_plan(const Scene<2> &, const MPI_Comm);
  template void
  print_plan(const Scene<3> &, const MPI_Comm);
} // namespace selkie
