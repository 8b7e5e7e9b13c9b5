// SPDX-License-Identifier: Apache-2.0
#include "acquire/usbtmc.h"

#include "acquire/usb_handles.h"

#include <fmt/format.h>

#include <algorithm>
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
constexpr std::uint8_t kUsbtmcClass = 0xFE, kUsbtmcSubclass = 0x03;
constexpr std::uint8_t kInitiateClear = 5, kCheckClearStatus = 6, kStatusPending = 2;

// Something was wrong with the exchange, not with the instrument: clearing may help.
struct Confused {
    std::string why;
};

std::optional<UsbtmcEndpoints> endpoints_of(libusb_device* device) {
    libusb_config_descriptor* raw = nullptr;
    if (libusb_get_active_config_descriptor(device, &raw) != 0)
        return std::nullopt;
    const UsbConfiguration configuration(raw);
    for (int k = 0; k < configuration->bNumInterfaces; ++k) {
        const libusb_interface_descriptor& interface = configuration->interface[k].altsetting[0];
        if (interface.bInterfaceClass != kUsbtmcClass ||
            interface.bInterfaceSubClass != kUsbtmcSubclass)
            continue;
        UsbtmcEndpoints found{interface.bInterfaceNumber, 0, 0};
        for (int j = 0; j < interface.bNumEndpoints; ++j) {
            const libusb_endpoint_descriptor& endpoint = interface.endpoint[j];
            if ((endpoint.bmAttributes & 3) != LIBUSB_TRANSFER_TYPE_BULK)
                continue;
            const bool is_in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
            (is_in ? found.in : found.out) = endpoint.bEndpointAddress;
        }
        if (found.in != 0 && found.out != 0)
            return found;
    }
    return std::nullopt;
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
    std::array<unsigned char, 256> bytes{};
    const int length = index == 0
                           ? 0
                           : libusb_get_string_descriptor_ascii(handle, index, bytes.data(),
                                                                static_cast<int>(bytes.size()));
    return length > 0 ? std::string(bytes.begin(), bytes.begin() + length) : std::string();
}

std::string vendor_product(const libusb_device_descriptor& descriptor) {
    return fmt::format("{:04x}:{:04x}", descriptor.idVendor, descriptor.idProduct);
}

// Calls use(device, found) for every instrument.
template <typename Use>
void for_each_instrument(libusb_context* context, const Use& use) {
    libusb_device** raw = nullptr;
    const ssize_t count = libusb_get_device_list(context, &raw);
    check_usb(static_cast<int>(count), "list USB devices", "USB");
    const UsbList list(raw);
    for (ssize_t k = 0; k < count; ++k) {
        libusb_device* device = list.get()[k];
        if (!endpoints_of(device))
            continue;
        libusb_device_descriptor descriptor{};
        libusb_get_device_descriptor(device, &descriptor);
        FoundInstrument found;
        found.address = fmt::format("usb {:03}:{:03}", libusb_get_bus_number(device),
                                    libusb_get_device_address(device));
        libusb_device_handle* opened = nullptr;
        if (libusb_open(device, &opened) == 0) {
            const UsbHandle handle(opened);
            found.vendor = text_of(opened, descriptor.iManufacturer);
            found.model = text_of(opened, descriptor.iProduct);
            found.serial = text_of(opened, descriptor.iSerialNumber);
        }
        found.id = found.serial.empty() ? vendor_product(descriptor) : found.serial;
        use(device, found, vendor_product(descriptor));
    }
}

}  // namespace

struct Usbtmc::Handle {
    UsbContext context = usb_context();
    UsbHandle device;  // closed first
    UsbtmcEndpoints endpoints;
};

std::vector<FoundInstrument> find_instruments() {
    const UsbContext context = usb_context();
    std::vector<FoundInstrument> all;
    for_each_instrument(context.get(), [&](libusb_device*, const FoundInstrument& found,
                                           const std::string&) { all.push_back(found); });
    std::sort(all.begin(), all.end(),
              [](const auto& a, const auto& b) { return a.address < b.address; });
    return all;
}

Usbtmc::Usbtmc(const std::string& device) : name_(device), handle_(std::make_unique<Handle>()) {
    std::vector<libusb_device*> meant;
    std::string listed;
    for_each_instrument(
        handle_->context.get(),
        [&](libusb_device* one, const FoundInstrument& found, const std::string& ids) {
            listed += (listed.empty() ? "" : ", ") + found.id;
            if (device == found.id || device == ids)
                meant.push_back(libusb_ref_device(one));
        });
    const std::unique_ptr<std::vector<libusb_device*>, void (*)(std::vector<libusb_device*>*)>
        unref(&meant, [](std::vector<libusb_device*>* list) {
            for (libusb_device* one : *list)
                libusb_unref_device(one);
        });
    if (meant.empty())
        throw DeviceLost{"no such instrument", device, "one of those connected",
                         listed.empty() ? "none" : listed};
    if (meant.size() > 1)
        throw Error{"which instrument is meant", device, "a serial number", listed};
    libusb_device_handle* opened = nullptr;
    check_usb(libusb_open(meant.front(), &opened), "open instrument", device);
    handle_->device.reset(opened);
    handle_->endpoints = *endpoints_of(meant.front());
    libusb_set_auto_detach_kernel_driver(opened, 1);
    check_usb(libusb_claim_interface(opened, handle_->endpoints.interface), "open instrument",
              device);
    clear();  // what a program that died has left in it
    identity_ = query("*IDN?");
    write("*CLS");
}

Usbtmc::~Usbtmc() {
    libusb_release_interface(handle_->device.get(), handle_->endpoints.interface);
}

std::uint8_t Usbtmc::next_tag() {
    tag_ = tag_ == 255 ? 1 : static_cast<std::uint8_t>(tag_ + 1);
    return tag_;
}

// One bulk transfer; a stalled endpoint is freed. Throws Confused where another try may help.
int Usbtmc::bulk(std::uint8_t endpoint, std::span<std::uint8_t> bytes, const char* what) {
    int count = 0;
    const int result = libusb_bulk_transfer(handle_->device.get(), endpoint, bytes.data(),
                                            static_cast<int>(bytes.size()), &count, kPatience_ms);
    if (result == LIBUSB_ERROR_PIPE) {
        libusb_clear_halt(handle_->device.get(), endpoint);
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
        bulk(handle_->endpoints.out, bytes, "write to instrument");
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
        bulk(handle_->endpoints.out, request, "ask instrument");
        std::array<std::uint8_t, 2 * kTransferBytes> bytes{};
        const auto read_at = [&](std::size_t at) {
            return static_cast<std::size_t>(bulk(handle_->endpoints.in,
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
    libusb_device_handle* device = handle_->device.get();
    constexpr std::uint8_t kClassFromInterface = 0xA1;
    std::array<std::uint8_t, 2> status{};
    const auto ask = [&](std::uint8_t request) {
        return libusb_control_transfer(device, kClassFromInterface, request, 0,
                                       handle_->endpoints.interface, status.data(),
                                       request == kInitiateClear ? 1 : 2, kPatience_ms);
    };
    if (ask(kInitiateClear) < 1)
        return;
    for (int k = 0; k < kMostStatusLooks; ++k)
        if (ask(kCheckClearStatus) < 1 || status[0] != kStatusPending)
            break;
    libusb_clear_halt(device, handle_->endpoints.out);
    libusb_clear_halt(device, handle_->endpoints.in);
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
