// SPDX-License-Identifier: Apache-2.0
/// The device's side of USBTMC, and what the lab's instruments answer in SCPI.
#pragma once

#include "sample_data/devices/lab_state.h"
#include "sample_data/devices/usb_device.h"

#include <atomic>
#include <string>

namespace nearfield::devices {

/// Misbehavior for tests. Zeros: none.
struct InstrumentFaults {
    std::atomic<int> silent_answers{0};   // so many next answers do not come
    std::atomic<int> stalled_answers{0};  // so many next answers stall the endpoint
    std::atomic<int> wrong_tags{0};       // so many next answers are to another question
    std::atomic<int> endless_answers{0};  // so many next answers claim 4 GiB
    std::atomic<bool> is_mute{false};     // no answer comes, clearing does not help
    std::atomic<bool> splits{false};      // answers come in transfers and messages of few bytes
};

/// A SCPI instrument behind USBTMC. Commands end with a line end; unknown ones become an error that
/// SYST:ERR? tells.
class Instrument : public UsbFunction {
  public:
    Instrument(std::string model, std::string serial, std::uint16_t product)
        : model_(std::move(model)), serial_(std::move(serial)), product_(product) {}

    std::vector<std::uint8_t> descriptors() const override;
    std::vector<std::string> texts() const override { return {"nearfield", model_, serial_}; }
    std::optional<std::vector<std::uint8_t>> control(std::span<const std::uint8_t> setup) override;
    bool take(std::uint8_t endpoint, std::span<const std::uint8_t> bytes) override;
    std::optional<Reply> give(std::uint8_t endpoint, std::size_t most_bytes) override;

    InstrumentFaults faults;

  protected:
    /// The answer to a question, empty to a command; nothing: it is not known or out of range.
    virtual std::optional<std::string> execute(const std::string& command) = 0;

  private:
    void obey(std::string command);
    std::vector<std::uint8_t> next_message();

    std::string model_, serial_;
    std::uint16_t product_;
    std::string input_, answer_, error_;
    std::vector<std::uint8_t> output_;  // of a message, what was not given yet
    std::uint8_t tag_ = 0;
    std::size_t asked_bytes_ = 0;  // 0: nothing is asked for
};

/// An illuminance meter: MEAS:ILL? in lx, where the bench's photometer is.
class LuxmeterModel : public Instrument {
  public:
    explicit LuxmeterModel(LabState& lab) : Instrument("VLUX", "NFLUX01", 0x0101), lab_(lab) {}

  private:
    std::optional<std::string> execute(const std::string& command) override;
    LabState& lab_;
};

/// A supply for the lamp: VOLT, CURR, OUTP, MEAS:VOLT?, MEAS:CURR?; limits current.
class SupplyModel : public Instrument {
  public:
    explicit SupplyModel(LabState& lab) : Instrument("VPSU", "NFPSU01", 0x0102), lab_(lab) {}

  private:
    std::optional<std::string> execute(const std::string& command) override;
    LabState& lab_;
    double voltage_v_ = 0, limit_a_ = 1;
    bool is_on_ = false;
};

}  // namespace nearfield::devices
