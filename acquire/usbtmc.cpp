// SPDX-License-Identifier: Apache-2.0
#include "acquire/usbtmc.h"

#include "acquire/usb_instruments.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace nearfield::acquire {
namespace {

constexpr unsigned kPatience_ms = 5000;  // a meter's slowest range
constexpr std::size_t kHeaderBytes = 12, kMostBytes = 4096, kMostAnswerBytes = 1 << 20;
// A transfer in: whole packets of any speed's size (64, 512, 1024), or longer ones overflow.
constexpr std::size_t kTransferBytes = 5120;
constexpr std::uint8_t kDevDepMsgOut = 1, kRequestDevDepMsgIn = 2, kEndOfMessage = 1;
constexpr std::uint8_t kInitiateClear = 5, kCheckClearStatus = 6, kStatusPending = 2;

// Something was wrong with the exchange, not with the instrument: clearing may help.
struct Confused {
    std::string why;
};

}  // namespace

struct Usbtmc::Handle {
    UsbContext context = usb_context();
    OpenInstrument instrument;  // closed first

    libusb_device_handle* device() const { return instrument.handle.get(); }
    const UsbtmcEndpoints& endpoints() const { return instrument.endpoints; }
};

Usbtmc::Usbtmc(const std::string& device) : name_(device), handle_(std::make_unique<Handle>()) {
    handle_->instrument = open_instrument(handle_->context.get(), device);
    clear();  // what a program that died has left in it
    identity_ = query("*IDN?");
    write("*CLS");
}

Usbtmc::~Usbtmc() {
    libusb_release_interface(handle_->device(), handle_->endpoints().interface);
}

std::uint8_t Usbtmc::next_tag() {
    tag_ = tag_ == 255 ? 1 : static_cast<std::uint8_t>(tag_ + 1);
    return tag_;
}

// One bulk transfer; a stalled endpoint is freed. Throws Confused where another try may help.
int Usbtmc::bulk(std::uint8_t endpoint, std::span<std::uint8_t> bytes, const char* what) {
    int count = 0;
    const int result = libusb_bulk_transfer(handle_->device(), endpoint, bytes.data(),
                                            static_cast<int>(bytes.size()), &count, kPatience_ms);
    if (result == LIBUSB_ERROR_PIPE) {
        libusb_clear_halt(handle_->device(), endpoint);
        throw Confused{"it stalled"};
    }
    if (result == LIBUSB_ERROR_TIMEOUT)
        throw Confused{"nothing within 5 s"};
    if (result == LIBUSB_ERROR_OVERFLOW)
        throw Confused{"more bytes than asked for"};
    check_usb(result, what, name_);
    return count;
}

void Usbtmc::write(const std::string& command) {
    std::vector<std::uint8_t> bytes(kHeaderBytes);
    const std::string line = command + "\n";
    bytes[0] = kDevDepMsgOut;
    bytes[1] = next_tag();
    bytes[2] = static_cast<std::uint8_t>(~bytes[1]);
    for (std::size_t k = 0; k < 4; ++k)
        bytes[4 + k] = static_cast<std::uint8_t>(line.size() >> (8 * k));
    bytes[8] = kEndOfMessage;
    bytes.insert(bytes.end(), line.begin(), line.end());
    bytes.resize((bytes.size() + 3) / 4 * 4);
    try {
        bulk(handle_->endpoints().out, bytes, "write to instrument");
    } catch (const Confused& confused) {
        throw DeviceLost{"the instrument does not listen", name_, "it to take " + command,
                         confused.why};
    }
}

// An answer comes in as many messages as the instrument likes; a message in as many transfers.
std::string Usbtmc::read_answer() {
    std::string answer;
    for (bool is_complete = false; !is_complete;) {
        std::array<std::uint8_t, kHeaderBytes> request{kRequestDevDepMsgIn, next_tag()};
        request[2] = static_cast<std::uint8_t>(~request[1]);
        request[5] = kMostBytes >> 8U;
        bulk(handle_->endpoints().out, request, "ask instrument");
        std::array<std::uint8_t, 2 * kTransferBytes> bytes{};
        const auto read_at = [&](std::size_t at) {
            return static_cast<std::size_t>(bulk(handle_->endpoints().in,
                                                 std::span(bytes).subspan(at, kTransferBytes),
                                                 "read instrument"));
        };
        std::size_t got = read_at(0);
        if (got < kHeaderBytes || bytes[0] != kRequestDevDepMsgIn || bytes[1] != request[1] ||
            bytes[2] != request[2])
            throw Confused{"an answer to another question"};
        std::size_t size = 0;
        for (std::size_t k = 0; k < 4; ++k)
            size |= std::size_t{bytes[4 + k]} << (8 * k);
        if (size == 0 || size > kMostBytes)
            throw Confused{fmt::format("an answer of {} bytes", size)};
        while (got < kHeaderBytes + size) {
            const std::size_t more = read_at(got);
            if (more == 0)
                throw Confused{"an answer cut short"};
            got += more;
        }
        answer.append(bytes.begin() + kHeaderBytes,
                      bytes.begin() + static_cast<std::ptrdiff_t>(kHeaderBytes + size));
        is_complete = (bytes[8] & kEndOfMessage) != 0;
        if (answer.size() > kMostAnswerBytes)
            throw Confused{"an answer without end"};
    }
    while (!answer.empty() && (answer.back() == '\n' || answer.back() == '\r'))
        answer.pop_back();
    return answer;
}

// Drops whatever the instrument was about to say or do with its input. Best effort: what does not
// answer to this does not answer to the next question either.
void Usbtmc::clear() {
    constexpr int kMostStatusLooks = 100;
    libusb_device_handle* device = handle_->device();
    constexpr std::uint8_t kClassFromInterface = 0xA1;
    std::array<std::uint8_t, 2> status{};
    const auto ask = [&](std::uint8_t request) {
        return libusb_control_transfer(device, kClassFromInterface, request, 0,
                                       handle_->endpoints().interface, status.data(),
                                       request == kInitiateClear ? 1 : 2, kPatience_ms);
    };
    if (ask(kInitiateClear) < 1)
        return;
    for (int k = 0; k < kMostStatusLooks; ++k)
        if (ask(kCheckClearStatus) < 1 || status[0] != kStatusPending)
            break;
    libusb_clear_halt(device, handle_->endpoints().out);
    libusb_clear_halt(device, handle_->endpoints().in);
}

std::string Usbtmc::query_once(const std::string& question) {
    write(question);
    return read_answer();
}

std::string Usbtmc::query(const std::string& question) {
    try {
        return query_once(question);
    } catch (const Confused&) {
        clear();
    }
    try {
        return query_once(question);
    } catch (const Confused& confused) {
        throw DeviceLost{"the instrument does not answer", name_, "an answer to " + question,
                         confused.why};
    }
}

double Usbtmc::number(const std::string& question) {
    const std::string answer = query(question);
    char* end = nullptr;
    const double value = std::strtod(answer.c_str(), &end);
    // SCPI says 9.91e37 for "not a number" and 9.9e37 for infinity.
    constexpr double kNoNumber = 9e37;
    if (end == answer.c_str() || !std::isfinite(value) || std::abs(value) > kNoNumber)
        throw Error{"bad answer of the instrument", name_ + ", " + question, "a number",
                    "'" + answer + "'"};
    return value;
}

void Usbtmc::check_errors() {
    const std::string answer = query("SYST:ERR?");
    if (!answer.starts_with("0") && !answer.starts_with("+0"))
        throw Error{"the instrument refuses", name_, "no error", answer};
}

}  // namespace nearfield::acquire
