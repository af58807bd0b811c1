// Runs as text: read again they are the same bits.
#include "saltus/io/csv.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "saltus/kernel/model/lagrangian_linear_tids.hpp"
#include "slider_crank/slider_crank.hpp"
#include "support/models.hpp"
#include "support/runs.hpp"

namespace saltus::test {
namespace {

std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t to; (to = text.find(separator, from)) != std::string::npos; from = to + separator.size())
    parts.push_back(text.substr(from, to - from));
  parts.push_back(text.substr(from));
  return parts;
}

TEST(Csv, ReadsBackToTheSameBits) {
  const auto model = examples::make_slider_crank(examples::Guidance::frictional);
  TimeStepping simulation(model, *make_integrator("HalfExplicitTrapezoidalOSI"), 1e-4);
  const auto recording = std::make_shared<Recording>();
  simulation.add_observer(recording);
  simulation.run(0.05);
  std::ostringstream text;
  write_csv_rows(text, *recording);
  const auto lines = split(text.str(), "\r\n");
  ASSERT_EQ(static_cast<long>(lines.size()), recording->rows() + 1);
  EXPECT_EQ(lines.back(), "");
  for (long row = 0; row < recording->rows(); ++row) {
    const auto fields = split(lines[row], ",");
    std::size_t next = 0;
    for (const Column& column : run_columns())
      std::visit(
          [&](auto member) {
            const auto& values = (*recording).*member;
            const long width = static_cast<long>(values.size()) / recording->rows();
            for (long k = 0; k < width; ++k)
              ASSERT_EQ(std::strtod(fields[next++].c_str(), nullptr),
                        static_cast<double>(values[row * width + k]))
                  << column.name;
          },
          column.values);
    ASSERT_EQ(next, fields.size());
  }
}

TEST(Csv, HeaderNamesEveryFieldWithItsUnit) {
  std::ostringstream text;
  write_csv_header(text, examples::make_slider_crank(examples::Guidance::frictional));
  const std::string header = text.str();
  EXPECT_EQ(header.substr(0, 42), "t [s],step [1],q0 [m or rad],q1 [m or rad]");
  EXPECT_EQ(header.substr(header.size() - 2), "\r\n");
  const auto fields = split(header, ",");
  EXPECT_EQ(fields.size(), 2u + 6 + 4 + 5 * 8 + 13);
  for (const char* title : {"upper left.gap0 [m]", "lower right.impulse1 [N s]", "v2 [m/s or rad/s]"})
    EXPECT_EQ(std::count(fields.begin(), fields.end(), title), 1) << title;
}

TEST(Csv, QuotesNamesThatHoldSeparators) {
  std::ostringstream text;
  write_csv_header(text, 1, 1, {{"a, \"b\"", 1, 1}});
  EXPECT_NE(text.str().find("\"a, \"\"b\"\".gap0 [m]\",\"a, \"\"b\"\".velocity0 [m/s]\""), std::string::npos);
}

TEST(Csv, WritesWhatIsNoNumberAsSuch) {
  Recording recording;
  for (const Column& column : run_columns())
    std::visit([&](auto member) { (recording.*member).push_back(1); }, column.values);
  recording.potential_energy[0] = std::nan("");
  recording.t[0] = 0.1;
  std::ostringstream text;
  write_csv_rows(text, recording);
  EXPECT_EQ(text.str(), "0.1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,nan,1,1,1,1,1,1,1\r\n");
}

}  // namespace
}  // namespace saltus::test
