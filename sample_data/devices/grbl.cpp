// SPDX-License-Identifier: Apache-2.0
#include "sample_data/devices/grbl.h"

#include "formats/files/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

namespace nearfield::devices {
namespace {

constexpr double kTravel_mm = 300, kPullOff_mm = 1;

// The number behind a letter; the value before where there is none.
double word_of(const std::string& line, char letter, double before) {
    const std::size_t at = line.find(letter);
    return at == std::string::npos ? before : std::strtod(line.c_str() + at + 1, nullptr);
}

}  // namespace

Grbl::Grbl(TestBed& bed, LabState& lab, int number)
    : lab_(lab), node_(fmt::format("{}/dev/ttyUSB{}", bed.root(), number)) {
    bed.add(fmt::format(
        "P: /devices/pci0000:00/0000:00:14.0/usb1/1-2{0}/1-2{0}:1.0/ttyUSB{0}/tty/ttyUSB{0}\n"
        "N: ttyUSB{0}\nE: DEVNAME=/dev/ttyUSB{0}\nE: SUBSYSTEM=tty\nE: MAJOR=188\nE: MINOR={0}\n"
        "A: dev=188:{0}\\n\n\n",
        number));
    terminal_ =
        umockdev_testbed_get_dev_fd(bed.get(), fmt::format("/dev/ttyUSB{}", number).c_str());
    thread_ = std::thread([this] { run(); });
}

Grbl::~Grbl() {
    is_ending_ = true;
    if (thread_.joinable())
        thread_.join();
    if (second_terminal_ >= 0)
        close(second_terminal_);
}

// The terminal's other end hangs up when this one is closed; its number stays the test bed's.
void Grbl::unplug() {
    is_ending_ = true;
    thread_.join();
    const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
    dup2(nothing, terminal_);
    close(nothing);
}

// The test bed makes no second terminal of one name: this one is our own, under the old name.
void Grbl::plug_in() {
    terminal_ = second_terminal_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios raw{};
    if (terminal_ < 0 || grantpt(terminal_) != 0 || unlockpt(terminal_) != 0 ||
        tcgetattr(terminal_, &raw) != 0)
        throw Error{"cannot make a terminal", node_, "", std::strerror(errno)};
    cfmakeraw(&raw);
    tcsetattr(terminal_, TCSANOW, &raw);
    std::array<char, 64> name{};
    ptsname_r(terminal_, name.data(), name.size());
    std::filesystem::remove(node_);
    std::filesystem::create_symlink(name.data(), node_);
    state_ = "Alarm";
    is_ending_ = false;
    thread_ = std::thread([this] { run(); });
}

void Grbl::run() {
    constexpr int kLook_ms = 2;
    while (!is_ending_) {
        pollfd ready{terminal_, POLLIN, 0};
        poll(&ready, 1, kLook_ms);
        char character = 0;
        if ((ready.revents & POLLIN) != 0 && read(terminal_, &character, 1) == 1)
            take(character);
        else if ((ready.revents & POLLHUP) != 0)
            usleep(1000 * kLook_ms);  // nobody has it open
        finish_move();
    }
}

void Grbl::say(const std::string& line) {
    const std::string bytes = line + "\r\n";
    for (std::size_t done = 0; done < bytes.size() && !faults.is_silent;) {
        const ssize_t count = write(terminal_, bytes.data() + done, bytes.size() - done);
        if (count <= 0)
            return;
        done += static_cast<std::size_t>(count);
    }
}

// Characters of real time are obeyed at once, wherever in a line they come.
void Grbl::take(char character) {
    constexpr char kReset = 0x18;
    if (character == kReset)
        return reset();
    if (character == '?')
        return say(report());
    if (character == '!' || character == '~') {
        if (state_ == "Run" && character == '!') {
            from_mm_ = to_mm_ = position_mm();
            state_ = "Hold:0";
        } else if (state_ == "Hold:0" && character == '~') {
            state_ = "Idle";
        }
        return;
    }
    if (character != '\n' && character != '\r')
        line_ += character;
    else if (!line_.empty())
        obey(std::exchange(line_, ""));
}

void Grbl::reset() {
    if (state_ == "Run")
        say("ALARM:3");
    from_mm_ = to_mm_ = position_mm();
    line_.clear();
    state_ = "Alarm";
    say("");
    say("Grbl 1.1h ['$' for help]");
    say("[MSG:'$H'|'$X' to unlock]");
}

void Grbl::alarm(int number) {
    from_mm_ = to_mm_ = position_mm();
    state_ = "Alarm";
    say(fmt::format("ALARM:{}", number));
}

void Grbl::home() {
    usleep(20'000);
    if (faults.fails_homing)
        return alarm(9);
    from_mm_ = to_mm_ = glm::dvec2(-kPullOff_mm);
    lab_.set_axes_mm(to_mm_);
    state_ = "Idle";
    say("ok");
}

void Grbl::start_move(const std::string& line) {
    const glm::dvec2 target{word_of(line, 'X', to_mm_.x), word_of(line, 'Y', to_mm_.y)};
    const double feed_mm_per_min = word_of(line, 'F', 0);
    if (feed_mm_per_min <= 0)
        return say("error:22");
    if (std::min(target.x, target.y) < -kTravel_mm || std::max(target.x, target.y) > 0)
        return alarm(2);
    from_mm_ = position_mm();
    to_mm_ = target - glm::dvec2(faults.lost_steps_mm.load(), 0);
    start_ = std::chrono::steady_clock::now();
    duration_s_ = glm::length(to_mm_ - from_mm_) / feed_mm_per_min * 60 / speed_up;
    state_ = "Run";
    say("ok");
}

void Grbl::obey(const std::string& line) {
    if (line == "$$") {
        say("$22=1");
        say(fmt::format("$130={:.3f}", kTravel_mm));
        say(fmt::format("$131={:.3f}", kTravel_mm));
        return say("ok");
    }
    if (line == "$H")
        return home();
    if (state_ == "Alarm")
        return say("error:9");  // locked
    if (line.find("G1") != std::string::npos && line.find("G53") != std::string::npos)
        return start_move(line);
    say("error:20");  // not known
}

glm::dvec2 Grbl::position_mm() const {
    if (state_ != "Run")
        return to_mm_;
    const double gone_s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double share = faults.is_stuck   ? 0
                         : duration_s_ > 0 ? std::min(1.0, gone_s / duration_s_)
                                           : 1;
    return from_mm_ + share * (to_mm_ - from_mm_);
}

void Grbl::finish_move() {
    if (state_ != "Run")
        return;
    const glm::dvec2 now_mm = position_mm();
    lab_.set_axes_mm(now_mm);
    if (faults.switch_at_mm < 0 && now_mm.x < faults.switch_at_mm)
        return alarm(1);
    if (now_mm == to_mm_)
        state_ = "Idle";
}

std::string Grbl::report() const {
    const glm::dvec2 now_mm = position_mm();
    return fmt::format("<{}|MPos:{:.3f},{:.3f},0.000|FS:0,0>", state_, now_mm.x, now_mm.y);
}

}  // namespace nearfield::devices
