// SPDX-License-Identifier: Apache-2.0
/// Instruments that speak SCPI over USB (test and measurement class) through libusb.
///
/// Source: USBTMC 1.0 (USB-IF), subclass 488 left aside: no service requests, no triggers.
#pragma once

#include "acquire/camera.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace nearfield::acquire {

struct FoundInstrument {
    std::string id;  // opens it: its serial number, or vendor:product where it has none
    std::string vendor, model, serial;
    std::string address;  // "usb 001:005"
};

/// The instruments that there are; those that may not be opened have no names.
std::vector<FoundInstrument> find_instruments();

class Usbtmc {
  public:
    /// Opens by serial number or vendor:product ("1234:5678"); takes the device from a kernel
    /// driver. Throws Error where several are meant, or it may not be opened, DeviceLost where it
    /// is not there.
    explicit Usbtmc(const std::string& device);
    ~Usbtmc();
    Usbtmc(const Usbtmc&) = delete;
    Usbtmc& operator=(const Usbtmc&) = delete;

    /// Sends a command. Throws DeviceLost where it is gone or silent.
    void write(const std::string& command);
    /// Sends a question and returns the answer without its line end. A silent or confused
    /// instrument is cleared and asked once more; then DeviceLost.
    std::string query(const std::string& question);
    /// The answer as a number. Throws Error where it is none.
    double number(const std::string& question);
    /// Throws Error with what the instrument says (SYST:ERR?) if it refused anything.
    void check_errors();

    /// "MAKER,MODEL,SERIAL,VERSION", as the instrument says.
    const std::string& identity() const { return identity_; }

  private:
    struct Handle;  // libusb's

    std::string query_once(const std::string& question);
    std::string read_answer();
    void clear();
    std::uint8_t next_tag();
    int bulk(std::uint8_t endpoint, std::span<std::uint8_t> bytes, const char* what);

    std::string name_, identity_;
    std::unique_ptr<Handle> handle_;
    std::uint8_t tag_ = 0;
};

}  // namespace nearfield::acquire
