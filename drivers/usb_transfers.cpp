#include "drivers/usb_transfers.hpp"

#include <atomic>
#include <libusb.h>
#include <mutex>
#include <vector>

namespace scree::drivers::usb {
namespace {

std::atomic<std::size_t> live_transfers{0};
std::atomic<std::size_t> abandoned_transfers{0};

TransferEnd status_of(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return TransferEnd::completed;
    case LIBUSB_TRANSFER_TIMED_OUT:
      return TransferEnd::timed_out;
    case LIBUSB_TRANSFER_STALL:
      return TransferEnd::stalled;
    case LIBUSB_TRANSFER_OVERFLOW:
      return TransferEnd::overflow;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return TransferEnd::no_device;
    case LIBUSB_TRANSFER_CANCELLED:
      return TransferEnd::cancelled;
    case LIBUSB_TRANSFER_ERROR:
      break;
  }
  return TransferEnd::error;
}

}  // namespace

struct Transfers::Slot {
  enum class State : std::uint8_t { idle, in_flight, back };
  explicit Slot(std::size_t size) : transfer(libusb_alloc_transfer(0)), buffer(size) { ++live_transfers; }
  ~Slot() {
    libusb_free_transfer(transfer);
    --live_transfers;
  }
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;

  libusb_transfer* transfer;
  std::vector<std::uint8_t> buffer;
  State state = State::idle;
  TransferEnd status = TransferEnd::completed;
  std::size_t bytes = 0;
  std::size_t* in_flight = nullptr;  ///< to be told; null = nobody is left
};

struct Transfers::Callbacks {
  /// Posts what came back, nothing else.
  static void LIBUSB_CALL done(libusb_transfer* transfer) {
    auto& slot = *static_cast<Slot*>(transfer->user_data);
    slot.status = status_of(transfer->status);
    slot.bytes = std::min(static_cast<std::size_t>(std::max(transfer->actual_length, 0)), slot.buffer.size());
    slot.state = Slot::State::back;
    if (slot.in_flight != nullptr) --*slot.in_flight;
  }
};

const char* to_string(TransferEnd status) {
  switch (status) {
    case TransferEnd::completed:
      return "completed";
    case TransferEnd::timed_out:
      return "timed out";
    case TransferEnd::stalled:
      return "stalled";
    case TransferEnd::overflow:
      return "overflow";
    case TransferEnd::error:
      return "error";
    case TransferEnd::no_device:
      return "no device";
    case TransferEnd::cancelled:
      break;
  }
  return "cancelled";
}

Result<std::unique_ptr<Transfers>> Transfers::make(libusb_device_handle* handle, const Interface& interface) {
  std::unique_ptr<Transfers> out(new Transfers);
  const std::size_t bytes = kTransferBytes / interface.max_packet * interface.max_packet;
  for (auto& slot : out->slots_) {
    slot = std::make_unique<Slot>(bytes);
    if (slot->transfer == nullptr) return Error{ErrorKind::unavailable, "expected memory for a transfer, found none"};
    slot->in_flight = &out->in_flight_;
    libusb_fill_bulk_transfer(slot->transfer, handle, interface.endpoint, slot->buffer.data(), static_cast<int>(bytes),
                              Callbacks::done, slot.get(), 0);  // silence is judged by messages, not by transfers
  }
  return out;
}

Transfers::~Transfers() {
  for (auto& slot : slots_) {
    if (!slot || slot->state != Slot::State::in_flight) continue;
    static std::mutex mutex;
    static auto& kept = *std::make_unique<std::vector<std::unique_ptr<Slot>>>().release();  // for good
    const std::lock_guard lock(mutex);
    ++abandoned_transfers;
    slot->in_flight = nullptr;
    kept.push_back(std::move(slot));
  }
}

int Transfers::submit() {
  for (std::size_t i = 0; i < kTransfers; ++i) {
    Slot& slot = *slots_[(head_ + i) % kTransfers];
    if (slot.state != Slot::State::idle) continue;
    if (const int code = submit(slot); code != 0) return code;
  }
  return 0;
}

int Transfers::submit(Slot& slot) {
  slot.state = Slot::State::in_flight;
  ++in_flight_;
  const int code = libusb_submit_transfer(slot.transfer);
  if (code == 0) return 0;
  slot.state = Slot::State::idle;
  --in_flight_;
  return code;
}

std::optional<Completion> Transfers::front() const {
  const Slot& slot = *slots_[head_];
  if (slot.state != Slot::State::back) return std::nullopt;
  return Completion{slot.status, std::span<const std::uint8_t>(slot.buffer).first(slot.bytes)};
}

int Transfers::release() {
  Slot& slot = *slots_[head_];
  retire();
  return submit(slot);
}

void Transfers::retire() {
  slots_[head_]->state = Slot::State::idle;
  head_ = (head_ + 1) % kTransfers;
}

void Transfers::cancel() {
  for (const auto& slot : slots_)
    if (slot->state == Slot::State::in_flight) libusb_cancel_transfer(slot->transfer);
}

void Transfers::discard() {
  for (const auto& slot : slots_) slot->state = Slot::State::idle;
  head_ = 0;
}

std::size_t Transfers::live() {
  return live_transfers;
}
std::size_t Transfers::abandoned() {
  return abandoned_transfers;
}

}  // namespace scree::drivers::usb
