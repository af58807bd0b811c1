// A main for fuzz targets where no fuzzer brings one: random bytes and mutations of them, from a seed.
// The input that runs is in a file before it runs, so that no crash and no hang can lose it.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;
using Clock = std::chrono::steady_clock;

constexpr int longest = 1500;
constexpr std::size_t most_kept = 200;
constexpr const char* usage =
    "Usage: %s [--seconds N] [--seed S|random] [--limit SECONDS OF ONE INPUT] [--input FILE]\n"
    "       %s FILE...   runs these inputs\n";

struct Options {
  double seconds = 10.0;
  std::uint64_t seed = 1;
  unsigned limit = 20;
  std::string input = "fuzz.input";  // where the input that runs is kept
  std::vector<std::string> replayed;
};

[[noreturn]] void refuse(const char* program) {
  std::fprintf(stderr, usage, program, program);
  std::exit(2);
}

Options parse(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word.rfind("--", 0) != 0) {
      options.replayed.push_back(word);
      continue;
    }
    if (++k == argc) refuse(argv[0]);
    const std::string value = argv[k];
    try {
      if (word == "--seconds")
        options.seconds = std::stod(value);
      else if (word == "--seed")
        options.seed = value == "random" ? std::random_device()() : std::stoull(value);
      else if (word == "--limit")
        options.limit = static_cast<unsigned>(std::stoul(value));
      else if (word == "--input")
        options.input = value;
      else
        refuse(argv[0]);
    } catch (const std::exception&) {
      refuse(argv[0]);
    }
  }
  return options;
}

extern "C" void say_that_it_hangs(int) {
  constexpr char message[] = "fuzz: one input takes longer than the limit\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, message, sizeof message - 1);
  std::abort();
}

void run(const Input& input, unsigned limit) {
  alarm(limit);
  LLVMFuzzerTestOneInput(input.data(), input.size());
  alarm(0);
}

std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    std::cerr << "fuzz: cannot read " << path << '\n';
    std::exit(2);
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : random_(seed) {}

  Input next() {
    Input input = kept_.empty() || below(4) == 0 ? fresh() : mutated(kept_[below(kept_.size())]);
    if (kept_.size() < most_kept)
      kept_.push_back(input);
    else
      kept_[below(most_kept)] = input;
    return input;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  Input fresh() {
    Input input(below(2) ? below(60) : below(longest));
    for (auto& byte : input) byte = static_cast<std::uint8_t>(random_());
    return input;
  }

  Input mutated(Input input) {
    for (std::size_t times = 1 + below(4); times > 0 && !input.empty(); --times) {
      const std::size_t at = below(input.size()),
                        count = 1 + below(std::min<std::size_t>(input.size() - at, 16));
      const auto place = input.begin() + static_cast<std::ptrdiff_t>(at);
      switch (below(6)) {
        case 0: *place ^= static_cast<std::uint8_t>(1u << below(8)); break;
        case 1: *place = static_cast<std::uint8_t>(random_()); break;
        case 2: std::fill_n(place, count, below(2) ? 0 : 0xff); break;
        case 3: input.erase(place, place + static_cast<std::ptrdiff_t>(count)); break;
        case 4: {
          const Input part(place, place + static_cast<std::ptrdiff_t>(count));
          input.insert(place, part.begin(), part.end());
          break;
        }
        default: {  // the beginning of one, the end of another
          const Input& other = kept_[below(kept_.size())];
          input.resize(at);
          if (other.size() > at)
            input.insert(input.end(), other.begin() + static_cast<std::ptrdiff_t>(at), other.end());
        }
      }
    }
    if (input.size() > longest) input.resize(longest);
    return input;
  }

  std::mt19937_64 random_;
  std::vector<Input> kept_;
};

void keep(const Input& input, const std::string& path) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(input.data()), static_cast<std::streamsize>(input.size()));
  if (file.flush()) return;
  std::cerr << "fuzz: cannot write " << path << '\n';
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  signal(SIGALRM, say_that_it_hangs);
  for (const std::string& path : options.replayed) run(bytes_of(path), options.limit);
  if (!options.replayed.empty()) return 0;
  std::cout << "seed " << options.seed << ", the input that fails is in "
            << std::filesystem::absolute(options.input).string() << std::endl;
  Generator generator(options.seed);
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  long runs = 0;
  for (; elapsed() < options.seconds; ++runs) {
    const Input input = generator.next();
    keep(input, options.input);
    run(input, options.limit);
  }
  std::filesystem::remove(options.input);
  std::cout << runs << " inputs in " << elapsed() << " s, no failure" << std::endl;
}
