#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/client/client_port.hpp"

namespace scree::test {
namespace {

/// Talks to piped_client.py; its docstring has the commands.
class PythonPort : public ClientPort {
 public:
  explicit PythonPort(const PortSettings& settings) {
    std::string key;
    if (settings.key)
      for (const std::uint8_t byte : settings.key->bytes) key += fmt::format("{:02x}", byte);
    const std::string script = SCREE_SOURCE_DIR "/tests/client/piped_client.py";
    std::vector<std::string> words{SCREE_PYTHON,
                                   script,
                                   settings.subscribe ? "1" : "0",
                                   std::to_string(settings.repeats),
                                   std::to_string(settings.key ? settings.key->id : 0),
                                   key};
    int to_child[2], from_child[2];
    if (pipe2(to_child, O_CLOEXEC) != 0 || pipe2(from_child, O_CLOEXEC) != 0) std::abort();
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    child_ = fork();
    if (child_ == 0) {
      dup2(to_child[0], STDIN_FILENO);
      dup2(from_child[1], STDOUT_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(to_child[0]);
    close(from_child[1]);
    in_ = to_child[1];
    out_ = from_child[0];
    signal(SIGPIPE, SIG_IGN);  // a child that died shows as a short read
  }
  PythonPort(const PythonPort&) = delete;
  PythonPort& operator=(const PythonPort&) = delete;
  ~PythonPort() override {
    flush();
    close(in_);
    close(out_);
    waitpid(child_, nullptr, 0);
  }

  void accept(std::span<const std::uint8_t> datagram, Nanoseconds now) override {
    put('A');
    put(static_cast<std::int64_t>(now.count()));
    put(static_cast<std::uint16_t>(datagram.size()));
    buffer_.insert(buffer_.end(), datagram.begin(), datagram.end());
    if (buffer_.size() > 60'000) flush();
  }
  std::vector<std::vector<std::uint8_t>> requests(Nanoseconds now) override {
    put('R');
    put(static_cast<std::int64_t>(now.count()));
    flush();
    std::vector<std::vector<std::uint8_t>> out(get<std::uint16_t>());
    for (auto& request : out) request = get_many<std::uint8_t>(get<std::uint16_t>());
    return out;
  }
  Shown show(Nanoseconds now) override {
    put('S');
    put(static_cast<std::int64_t>(now.count()));
    flush();
    Shown out;
    out.state = static_cast<client::State>(get<std::uint8_t>());
    out.grid.resolution_m = get<double>();
    out.grid.x_min_m = get<double>();
    out.grid.y_min_m = get<double>();
    out.grid.x_min_cells = get<std::int32_t>();
    out.grid.y_min_cells = get<std::int32_t>();
    out.grid.columns = get<std::uint32_t>();
    out.grid.rows = get<std::uint32_t>();
    out.accepted = get<std::uint64_t>();
    out.datagrams = get<std::uint64_t>();
    out.memory = get<std::uint64_t>();
    const std::size_t cells = out.grid.cells();
    out.cost = get_many<std::uint8_t>(cells);
    out.occupancy = get_many<std::int8_t>(cells);
    out.elevation = get_many<float>(cells);
    out.cell_state = get_many<float>(cells);
    return out;
  }
  std::vector<std::uint32_t> revisions(std::int32_t tx, std::int32_t ty, int columns, int rows) override {
    put('V');
    for (const std::int32_t value : {tx, ty, std::int32_t{columns}, std::int32_t{rows}}) put(value);
    flush();
    return get_many<std::uint32_t>(static_cast<std::size_t>(3 * columns * rows));
  }

 private:
  template <class Value>
  void put(Value value) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&value);
    buffer_.insert(buffer_.end(), bytes, bytes + sizeof value);
  }
  void flush() {
    for (std::size_t done = 0; done < buffer_.size();) {
      const ssize_t written = write(in_, buffer_.data() + done, buffer_.size() - done);
      if (written <= 0) break;
      done += static_cast<std::size_t>(written);
    }
    buffer_.clear();
  }
  template <class Value>
  std::vector<Value> get_many(std::size_t count) {
    std::vector<Value> out(count);
    auto* const bytes = reinterpret_cast<char*>(out.data());
    for (std::size_t done = 0; done < count * sizeof(Value);) {
      const ssize_t received = read(out_, bytes + done, count * sizeof(Value) - done);
      if (received <= 0) {
        std::fprintf(stderr, "the Python client ended early\n");
        std::abort();
      }
      done += static_cast<std::size_t>(received);
    }
    return out;
  }
  template <class Value>
  Value get() {
    return get_many<Value>(1)[0];
  }

  pid_t child_ = -1;
  int in_ = -1, out_ = -1;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace

std::unique_ptr<ClientPort> python_port(const PortSettings& settings) {
  return std::make_unique<PythonPort>(settings);
}

}  // namespace scree::test
