#pragma once
#include <iosfwd>
#include <string>
#include <vector>

#include "saltus/io/recording.hpp"
#include "saltus/kernel/model/nonsmooth_dynamical_system.hpp"

namespace saltus {

/// A contact, and how many values it has in a row of a run.
struct ContactWidth {
  std::string name;
  int rows;  ///< of Wᵀ
  int gaps;
};

/// The first line of a table (RFC 4180): names with units in brackets, `t [s],step [1],q0 [m or rad],...`.
/// Values of a contact are called `name.impulse0 [N s]`, the normal row being 0.
/// @param coordinates, freedoms  of the whole model
void write_csv_header(std::ostream& out, int coordinates, int freedoms,
                      const std::vector<ContactWidth>& contacts);
void write_csv_header(std::ostream& out, const NonSmoothDynamicalSystem& model);

/// A line for each row. Numbers have as many digits as reading the same bits again takes.
void write_csv_rows(std::ostream& out, const Recording& rows);

}  // namespace saltus
