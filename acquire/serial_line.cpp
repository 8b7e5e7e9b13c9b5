// SPDX-License-Identifier: Apache-2.0
#include "acquire/serial_line.h"

#include "formats/files/error.h"
#include "formats/files/provenance.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace nearfield::acquire {

std::vector<std::string> find_serial_lines() {
    constexpr int kMost = 16;
    std::vector<std::string> found;
    for (const char* kind : {"/dev/ttyUSB", "/dev/ttyACM"})
        for (int k = 0; k < kMost; ++k)
            if (const std::string path = kind + std::to_string(k); access(path.c_str(), F_OK) == 0)
                found.push_back(path);
    return found;
}

SerialLine::SerialLine(std::string path) : path_(std::move(path)) {
    file_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file_ < 0) {
        if (errno == ENOENT || errno == ENXIO || errno == ENODEV || errno == EIO)
            lost(system_error());
        throw Error{"cannot open serial line", path_, "one that may be opened (docs/bench.md)",
                    system_error()};
    }
    termios settings{};
    const bool is_terminal = tcgetattr(file_, &settings) == 0;
    cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
    cfsetspeed(&settings, B115200);
    if (!is_terminal || tcsetattr(file_, TCSANOW, &settings) != 0) {
        const std::string why = system_error();
        close(file_);
        throw Error{"cannot open serial line", path_, "a terminal device", why};
    }
    // Two programs on one line would read each other's answers.
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
        close(file_);
        throw DeviceBusy{"cannot open serial line", path_, "one that no other program has",
                         "another has it"};
    }
}

SerialLine::~SerialLine() {
    close(file_);
}

void SerialLine::lost(const std::string& why) const {
    throw DeviceLost{"the serial line is gone", path_, "the device to answer", why};
}

void SerialLine::write(const std::string& bytes) {
    constexpr int kWritePatience_ms = 5000;
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t written = ::write(file_, bytes.data() + done, bytes.size() - done);
        if (written > 0) {
            done += static_cast<std::size_t>(written);
            continue;
        }
        if (written < 0 && errno != EAGAIN && errno != EINTR)
            lost(system_error());
        pollfd ready{file_, POLLOUT, 0};
        if (poll(&ready, 1, kWritePatience_ms) == 0)
            lost("nothing can be written");
    }
}

// True where something came.
bool SerialLine::read_some(double patience_s) {
    pollfd ready{file_, POLLIN, 0};
    const int count = poll(&ready, 1, static_cast<int>(std::max(0.0, patience_s) * 1000));
    if (count <= 0)
        return false;
    std::array<char, 256> bytes{};
    const ssize_t got = ::read(file_, bytes.data(), bytes.size());
    if (got > 0) {
        waiting_.append(bytes.data(), static_cast<std::size_t>(got));
        return true;
    }
    if (got < 0 && (errno == EAGAIN || errno == EINTR))
        return false;
    lost(got == 0 ? "hung up" : system_error());
}

std::optional<std::string> SerialLine::read_line(double patience_s) {
    for (const double end_s = now_s() + patience_s;;) {
        const std::size_t end = waiting_.find('\n');
        if (end != std::string::npos) {
            std::string line = waiting_.substr(0, end);
            waiting_.erase(0, end + 1);
            while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
                line.pop_back();
            return line;
        }
        const double left_s = end_s - now_s();
        if (!read_some(left_s) && now_s() >= end_s)
            return std::nullopt;
    }
}

void SerialLine::drop_input() {
    while (read_some(0))
        continue;
    waiting_.clear();
}

}  // namespace nearfield::acquire
