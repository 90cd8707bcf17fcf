#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/drivers/residual_scales.h>

#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  /**
   * Says for a message where a residual is largest and what it is made of: the
   * node, the body and point next to it, the direction, and each term's part.
   * Assembles once for each term. Collective; the same text on all ranks.
   */
  template <int dim>
  std::string
  describe_residual(const Scene<dim>                                    &scene,
                    const std::vector<std::shared_ptr<const Term<dim>>> &terms,
                    System<dim>                                         &system,
                    const SupportTable<dim>                             &table,
                    const StepTime                                      &time,
                    StepFields                                          &fields,
                    const ResidualScales                                &scales,
                    const Vector &residual);
} // namespace selkie
