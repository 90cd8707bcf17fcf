#pragma once

#include <deal.II/base/mpi.h>

#include <exception>
#include <string>

namespace selkie
{
  /**
   * Throws Error on all ranks when some rank brings a message, with the
   * message of the lowest such rank; does nothing when all messages are empty.
   * Collective: without it the ranks that saw no error would hang.
   */
  template <typename Error>
  void
  throw_on_all_ranks(const MPI_Comm comm, const std::string &message)
  {
    const unsigned int found = message.empty() ? 0 : 1;
    if (dealii::Utilities::MPI::max(found, comm) == 0)
      return;
    for (const std::string &text :
         dealii::Utilities::MPI::all_gather(comm, message))
      if (!text.empty())
        throw Error(text);
  }

  /**
   * Runs an action that may fail on some ranks only, such as writing a file:
   * what it throws on one is thrown on all, as Error. Collective; the action
   * itself must not communicate.
   */
  template <typename Error, typename Action>
  void
  fail_together(const MPI_Comm comm, const Action &action)
  {
    std::string failure;
    try
      {
        action();
      }
    catch (const std::exception &error)
      {
        failure = error.what();
      }
    throw_on_all_ranks<Error>(comm, failure);
  }
} // namespace selkie
