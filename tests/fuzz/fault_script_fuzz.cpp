// Fault scripts, and the damage that they do: any text is faults in order or an error that names a line.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "drivers/fault_script.hpp"

namespace {

void expect(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scree::drivers;
  const auto faults = parse_fault_script({reinterpret_cast<const char*>(data), size}, "f");
  if (!faults) {
    expect(faults.error().message.starts_with("f:"));
    expect(faults.error().message.find(": expected ") != std::string::npos);
    return 0;
  }
  scree::Duration before{0};
  for (const Fault& fault : *faults) {
    expect(fault.at >= before && fault.line > 0);
    before = fault.at;
    expect(needs_endpoint(fault.kind) || fault.lasts > scree::Duration{0} || fault.frames > 0);
    expect(fault.factor > 0.0);
  }
  return 0;
}
