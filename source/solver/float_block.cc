#include <selkie/assembly/row_products.h>
#include <selkie/solver/float_block.h>

namespace selkie
{
  FloatVector
  float_vector(const SystemMatrix &matrix)
  {
    FloatVector result;
    result.reinit(matrix.columns());
    return result;
  }


  template <int dim>
  FloatBlock::FloatBlock(const System<dim> &system,
                         const Part         rows,
                         const Part         columns)
  {
    const SystemMatrix &K           = system.matrix();
    const auto          is_in_block = [&](const RowGroup &group) {
      return (group.first_row < system.n_owned_displacements()) ==
             (rows == Part::displacements);
    };
    const auto for_each_run = [&](const RowGroup &group, const auto &action) {
      for (const ColumnRun &run : group.columns)
        if (run.pressures == (columns == Part::pressures))
          action(run);
    };

    std::size_t n_groups = 0, n_runs = 0, n_values = 0;
    K.for_each_owned_group([&](const RowGroup &group) {
      if (!is_in_block(group))
        return;
      ++n_groups;
      for_each_run(group, [&](const ColumnRun &run) {
        ++n_runs;
        n_values += group.n_rows * run.length();
      });
    });
    groups.reserve(n_groups);
    runs.reserve(n_runs);
    values.reserve(n_values);

    K.for_each_owned_group([&](const RowGroup &group) {
      if (!is_in_block(group))
        return;
      const unsigned int begin = runs.size();
      for_each_run(group, [&](const ColumnRun &run) {
        runs.push_back({static_cast<unsigned int>(run.begin), run.length()});
        for (unsigned int r = 0; r < group.n_rows; ++r)
          {
            const double *row = K.row_values(group.first_row + r);
            values.insert(values.end(),
                          row + run.position,
                          row + run.position + run.length());
          }
      });
      groups.push_back({group.first_row,
                        group.n_rows,
                        begin,
                        static_cast<unsigned int>(runs.size())});
    });
  }


  void
  FloatBlock::vmult(FloatVector &y, const FloatVector &x) const
  {
    x.update_ghost_values();
    y = 0.f;
    vmult_add(y, 1.f, x);
    x.zero_out_ghost_values();
  }


  namespace
  {
    /// Adds the products of some rows; returns where the next rows' values are.
    template <unsigned int n_rows, typename Run>
    const float *
    add_products(const Run   *run,
                 const Run   *end,
                 const float *value,
                 const float *x,
                 const float  factor,
                 float       *y)
    {
      RowProducts<n_rows, float> products;
      for (; run != end; value += n_rows * run->length, ++run)
        products.add(value, run->length, x + run->column, run->length);
#pragma GCC unroll 4
      for (unsigned int r = 0; r < n_rows; ++r)
        y[r] += factor * products[r];
      return value;
    }
  } // namespace


  void
  FloatBlock::vmult_add(FloatVector       &y,
                        const float        factor,
                        const FloatVector &x) const
  {
    const float *value = values.data();
    for (const Rows &rows : groups)
      {
        const auto add = [&](const auto product) {
          value = product(runs.data() + rows.begin,
                          runs.data() + rows.end,
                          value,
                          x.begin(),
                          factor,
                          y.begin() + rows.first);
        };
        switch (rows.n)
          {
            case 1:
              add(add_products<1, Run>);
              break;
            case 2:
              add(add_products<2, Run>);
              break;
            default:
              add(add_products<3, Run>);
          }
      }
  }

  template FloatBlock::FloatBlock(const System<2> &, const Part, const Part);
  template FloatBlock::FloatBlock(const System<3> &, const Part, const Part);
} // namespace selkie
