#include <selkie/solver/multigrid.h>

#include <ml_MultiLevelPreconditioner.h>

#include <string>

namespace selkie
{
  using namespace dealii;

  Epetra_Vector
  epetra_view(const Epetra_BlockMap &map, const double *values)
  {
    return Epetra_Vector(View, map, const_cast<double *>(values));
  }


  Multigrid::Multigrid(const Epetra_CrsMatrix            &matrix,
                       const unsigned int                 n_equations,
                       std::vector<std::vector<double>> &&all_places,
                       std::vector<std::vector<double>> &&modes)
    : places(std::move(all_places))
  {
    Teuchos::ParameterList list;
    ML_Epetra::SetDefaults("SA", list);
    list.set("ML output", 0);
    list.set("PDE equations", static_cast<int>(n_equations));
    list.set("aggregation: threshold", 0.02);
    list.set("aggregation: type", "Uncoupled");
    list.set("smoother: type", "Chebyshev");
    list.set("smoother: sweeps", 2);
    list.set("smoother: Chebyshev alpha", 8.);
    list.set("coarse: type", "Amesos-KLU");
    list.set("coarse: max size", 500);
    if (matrix.Comm().NumProc() > 1)
      {
        // Aggregates do not cross ranks: left alone, the coarsest level has one
        // a rank at least, and each of its unknowns is exchanged.
        list.set("repartition: enable", 1);
        list.set("repartition: partitioner", "Zoltan");
        list.set("repartition: Zoltan dimensions",
                 static_cast<int>(places.size()));
        for (unsigned int d = 0; d < places.size(); ++d)
          {
            places[d].reserve(1); // without a node, too: ML takes no null
            list.set(std::string(1, "xyz"[d]) + "-coordinates",
                     places[d].data());
          }
      }
    for (const auto &mode : modes)
      null_space.insert(null_space.end(), mode.begin(), mode.end());
    if (!modes.empty())
      {
        list.set("null space: type", "pre-computed");
        list.set("null space: dimension", static_cast<int>(modes.size()));
        list.set("null space: vectors", null_space.data());
      }
    ml = std::make_unique<ML_Epetra::MultiLevelPreconditioner>(matrix, list);
  }


  Multigrid::~Multigrid() = default;


  void
  Multigrid::apply(const double *b, double *x) const
  {
    const auto &map   = ml->OperatorRangeMap();
    auto        b_epe = epetra_view(map, b);
    auto        x_epe = epetra_view(map, x);
    ml->ApplyInverse(b_epe, x_epe);
  }


  template <int dim>
  std::vector<std::vector<double>>
  node_places(const System<dim> &system)
  {
    std::vector<std::vector<double>> places(dim);
    for (const unsigned int node : system.owned_nodes())
      for (unsigned int d = 0; d < dim; ++d)
        places[d].push_back(system.cloud.position(node)[d]);
    return places;
  }

  template std::vector<std::vector<double>>
  node_places(const System<2> &);
  template std::vector<std::vector<double>>
  node_places(const System<3> &);


  template <int dim>
  std::vector<std::vector<double>>
  rigid_body_modes(const System<dim> &system)
  {
    constexpr unsigned int           n_modes = dim == 2 ? 3 : 6;
    const auto                      &nodes   = system.owned_nodes();
    std::vector<std::vector<double>> modes(
      n_modes, std::vector<double>(dim * nodes.size(), 0.));
    for (unsigned int k = 0; k < nodes.size(); ++k)
      {
        const Point<dim> &x = system.cloud.position(nodes[k]);
        for (unsigned int d = 0; d < dim; ++d)
          modes[d][dim * k + d] = 1.;
        unsigned int mode = dim;
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = i + 1; j < dim; ++j, ++mode)
            {
              modes[mode][dim * k + i] = -x[j];
              modes[mode][dim * k + j] = x[i];
            }
        for (unsigned int d = 0; d < dim; ++d)
          if (system.held(dim * k + d))
            for (auto &m : modes)
              m[dim * k + d] = 0.;
      }
    return modes;
  }

  template std::vector<std::vector<double>>
  rigid_body_modes(const System<2> &);
  template std::vector<std::vector<double>>
  rigid_body_modes(const System<3> &);
} // namespace selkie
