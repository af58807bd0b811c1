// The ball in a box of Section 5.2 in C++: prints the run as CSV while it goes on, `ball_in_box > ball.csv`.
#include <exception>
#include <iostream>

#include "ball_in_box/ball_in_box.hpp"
#include "saltus/io/csv.hpp"
#include "saltus/kernel/integrators/registry.hpp"
#include "saltus/kernel/simulation/time_stepping.hpp"

int main() try {
  const auto model = saltus::examples::make_ball_in_box(saltus::examples::Gravity::oblique);
  const auto scheme = saltus::make_integrator("HalfExplicitTrapezoidalOSI");
  saltus::TimeStepping simulation(model, *scheme, 5e-3);

  saltus::write_csv_header(std::cout, model);
  const auto recording = std::make_shared<saltus::Recording>();
  const auto print = [](const saltus::Recording& chunk) { saltus::write_csv_rows(std::cout, chunk); };
  recording->stream(print, 100, 1.0);  // of a long run, no more than 100 rows are ever in memory
  simulation.add_observer(recording);
  simulation.run(2.0);
  recording->flush();
} catch (const std::exception& error) {
  std::cerr << "ball_in_box: " << error.what() << '\n';
  return 1;
}
