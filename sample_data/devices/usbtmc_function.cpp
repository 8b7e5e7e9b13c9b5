// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/usbtmc_function.h"

#include "sample_data/devices/little_endian.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace nearfield::devices {
namespace {

constexpr std::uint16_t kVendor = 0xCAFE;
constexpr std::uint8_t kOut = 1, kRequestIn = 2, kEndOfMessage = 1;
constexpr std::uint8_t kInitiateClear = 5, kCheckClear = 6, kGetCapabilities = 7, kSuccess = 1;
constexpr std::size_t kHeaderBytes = 12, kSplitMessage = 5, kSplitTransfer = 16;
constexpr double kMost_v = 60, kMost_a = 20;

bool take_one(std::atomic<int>& count) {
    if (count <= 0)
        return false;
    --count;
    return true;
}

// "VOLT 12.0": the number behind the word, where the command begins with it.
std::optional<double> argument_of(const std::string& command, const std::string& word) {
    if (!command.starts_with(word + " "))
        return std::nullopt;
    return std::strtod(command.c_str() + word.size(), nullptr);
}

}  // namespace

std::vector<std::uint8_t> Instrument::descriptors() const {
    // Device; configuration with one USBTMC interface and bulk endpoints 0x01, 0x82.
    std::vector<std::uint8_t> bytes{18, 1, 0x00, 0x02, 0, 0, 0, 64};
    append(bytes, kVendor, 2);
    append(bytes, product_, 2);
    const std::vector<std::uint8_t> rest{0x00, 0x01, 1,    2,    3,    1,                  //
                                         9,    2,    32,   0,    1,    1,    0, 0x80, 50,  //
                                         9,    4,    0,    0,    2,    0xFE, 3, 0,    0,   //
                                         7,    5,    0x01, 2,    0x00, 0x02, 0, 7,    5,
                                         0x82, 2,    0x00, 0x02, 0};
    bytes.insert(bytes.end(), rest.begin(), rest.end());
    return bytes;
}

std::optional<std::vector<std::uint8_t>> Instrument::control(std::span<const std::uint8_t> setup) {
    switch (setup[1]) {
        case kInitiateClear:
            answer_.clear();
            output_.clear();
            input_.clear();
            asked_bytes_ = 0;
            return std::vector<std::uint8_t>{kSuccess};
        case kCheckClear:
            return std::vector<std::uint8_t>{kSuccess, 0};
        case kGetCapabilities: {
            std::vector<std::uint8_t> bytes(24);
            bytes[0] = kSuccess;
            return bytes;
        }
        default:
            return std::nullopt;
    }
}

void Instrument::obey(std::string command) {
    while (!command.empty() && (command.back() == '\n' || command.back() == '\r'))
        command.pop_back();
    answer_.clear();
    if (command == "*CLS") {
        error_.clear();
    } else if (command == "*IDN?") {
        answer_ = fmt::format("NEARFIELD,{},{},1", model_, serial_);
    } else if (command == "SYST:ERR?") {
        answer_ = error_.empty() ? "0,\"No error\"" : std::exchange(error_, "");
    } else if (const auto answer = execute(command)) {
        answer_ = *answer;
    } else {
        error_ = fmt::format("-222,\"Data out of range or unknown: {}\"", command);
    }
    if (!answer_.empty())
        answer_ += '\n';
}

bool Instrument::take(std::uint8_t /*endpoint*/, std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kHeaderBytes || bytes[2] != (~bytes[1] & 0xFFU))
        return false;
    const std::size_t size = number_at(bytes, 4, 4);
    if (bytes[0] == kOut && size <= bytes.size() - kHeaderBytes) {
        const auto text = bytes.subspan(kHeaderBytes, size);
        input_.append(text.begin(), text.end());
        if ((bytes[8] & kEndOfMessage) != 0)
            obey(std::exchange(input_, ""));
        return true;
    }
    if (bytes[0] == kRequestIn) {
        tag_ = bytes[1];
        asked_bytes_ = size;
        return true;
    }
    return false;
}

// One message in, of the answer as much as was asked for.
std::vector<std::uint8_t> Instrument::next_message() {
    const bool is_to_another = take_one(faults.wrong_tags);
    if (is_to_another)
        answer_ = "0\n";
    const std::size_t size =
        std::min({answer_.size(), asked_bytes_, faults.splits ? kSplitMessage : answer_.size()});
    const std::uint8_t tag = is_to_another ? tag_ ^ 0x55U : tag_;
    std::vector<std::uint8_t> bytes{kRequestIn, tag, static_cast<std::uint8_t>(~tag), 0};
    append(bytes, take_one(faults.endless_answers) ? 0xFFFFFFFFU : size, 4);
    append(bytes, size == answer_.size() ? kEndOfMessage : 0, 4);
    bytes.insert(bytes.end(), answer_.begin(), answer_.begin() + static_cast<std::ptrdiff_t>(size));
    bytes.resize((bytes.size() + 3) / 4 * 4);
    answer_.erase(0, size);
    asked_bytes_ = 0;
    return bytes;
}

std::optional<UsbFunction::Reply> Instrument::give(std::uint8_t /*endpoint*/,
                                                   std::size_t most_bytes) {
    if (output_.empty()) {
        if (asked_bytes_ == 0 || answer_.empty() || faults.is_mute)
            return std::nullopt;
        if (take_one(faults.silent_answers)) {
            answer_.clear();
            return std::nullopt;
        }
        if (take_one(faults.stalled_answers)) {
            answer_.clear();
            return Reply{true, {}};
        }
        output_ = next_message();
    }
    const std::size_t count =
        std::min({output_.size(), most_bytes, faults.splits ? kSplitTransfer : most_bytes});
    const auto end = output_.begin() + static_cast<std::ptrdiff_t>(count);
    Reply reply{false, {output_.begin(), end}};
    output_.erase(output_.begin(), end);
    return reply;
}

std::optional<std::string> LuxmeterModel::execute(const std::string& command) {
    if (command == "MEAS:ILL?")
        return fmt::format("{:.6E}", lab_.illuminance_lx());
    return std::nullopt;
}

std::optional<std::string> SupplyModel::execute(const std::string& command) {
    const bool is_limited = is_on_ && lab_.lamp_current_a() > limit_a_;
    if (const auto volts = argument_of(command, "VOLT")) {
        if (*volts < 0 || *volts > kMost_v)
            return std::nullopt;
        voltage_v_ = *volts;
    } else if (const auto amperes = argument_of(command, "CURR")) {
        if (*amperes < 0 || *amperes > kMost_a)
            return std::nullopt;
        limit_a_ = *amperes;
    } else if (command == "OUTP ON" || command == "OUTP OFF") {
        is_on_ = command == "OUTP ON";
    } else if (command == "VOLT?") {
        return fmt::format("{:.4f}", voltage_v_);
    } else if (command == "CURR?") {
        return fmt::format("{:.4f}", limit_a_);
    } else if (command == "OUTP?") {
        return is_on_ ? "1" : "0";
    } else if (command == "MEAS:VOLT?") {
        const double share = is_limited ? limit_a_ / lab_.lamp_current_a() : 1;
        return fmt::format("{:.4f}", is_on_ ? share * voltage_v_ : 0);
    } else if (command == "MEAS:CURR?") {
        return fmt::format("{:.4f}", is_limited ? limit_a_ : lab_.lamp_current_a());
    } else {
        return std::nullopt;
    }
    lab_.set_lamp(is_on_, voltage_v_);
    return std::string();
}

}  // namespace nearfield::devices
