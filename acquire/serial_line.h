// SPDX-License-Identifier: Apache-2.0
/// A serial line that speaks in lines of text.
#pragma once

#include "acquire/camera.h"

#include <optional>
#include <string>
#include <vector>

namespace nearfield::acquire {

/// The serial lines over USB that there are: /dev/ttyUSBn, /dev/ttyACMn. Nothing is sent: opening
/// one would reset some boards.
std::vector<std::string> find_serial_lines();

class SerialLine {
  public:
    /// Opens a terminal device at 115200 baud, 8N1, raw, for us alone. Throws Error where it is no
    /// terminal or may not be opened, DeviceBusy where it is in use, DeviceLost where it is not
    /// there.
    explicit SerialLine(std::string path);
    ~SerialLine();
    SerialLine(const SerialLine&) = delete;
    SerialLine& operator=(const SerialLine&) = delete;

    const std::string& path() const { return path_; }
    /// Throws DeviceLost where it is gone.
    void write(const std::string& bytes);
    /// The next line without its end, or nothing within the time. Throws DeviceLost where it is
    /// gone.
    std::optional<std::string> read_line(double patience_s);
    /// Drops what has come and was not read.
    void drop_input();

  private:
    [[noreturn]] void lost(const std::string& why) const;
    bool read_some(double patience_s);

    std::string path_, waiting_;
    int file_ = -1;
};

}  // namespace nearfield::acquire
