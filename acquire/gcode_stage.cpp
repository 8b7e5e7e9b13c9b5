// SPDX-License-Identifier: Apache-2.0
#include "acquire/gcode_stage.h"

#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace nearfield::acquire {
namespace {

constexpr double kLook_s = 0.05;   // between looks at Ctrl-C
constexpr double kAnswer_s = 5;    // of a command that does not move
constexpr double kHoming_s = 180;  // a meter at a slow search speed
constexpr char kReset = 0x18, kStatus = '?', kHold = '!';

struct Code {
    int number;
    const char* meaning;
};

constexpr std::array<Code, 9> kAlarms = {{{1, "a limit switch was hit; its position is lost"},
                                          {2, "the target is beyond the travel"},
                                          {3, "reset while it moved; its position is lost"},
                                          {4, "probe"},
                                          {5, "probe"},
                                          {6, "homing was reset"},
                                          {7, "a door was opened while it homed"},
                                          {8, "homing did not clear the switch"},
                                          {9, "homing did not find the switch"}}};

std::string alarm_text(const std::string& line) {
    const int number = std::atoi(line.c_str() + std::string("ALARM:").size());
    for (const Code& code : kAlarms)
        if (code.number == number)
            return fmt::format("{} ({})", line, code.meaning);
    return line;
}

// Everything that says that it has stopped and will not go on by itself.
void check_alarm(const std::string& line, const std::string& where) {
    if (line.starts_with("ALARM:"))
        throw Error{"the stage is in alarm", where, "no alarm", alarm_text(line)};
}

std::vector<double> numbers_in(const std::string& text) {
    std::vector<double> numbers;
    for (const char *at = text.data(), *end = at + text.size(); at < end;) {
        double value = 0;
        const auto [next, failure] = std::from_chars(at, end, value);
        if (failure != std::errc())
            break;
        numbers.push_back(value);
        at = next + 1;
    }
    return numbers;
}

}  // namespace

GcodeStatus gcode_status_from(const std::string& line, const std::string& where) {
    const auto fail = [&] {
        throw Error{"bad answer of the stage", where, "<State|MPos:x,y,z|...>", line};
    };
    constexpr const char* kPosition = "|MPos:";
    const std::size_t position = line.find(kPosition);
    if (line.size() < 3 || line.front() != '<' || line.back() != '>' ||
        position == std::string::npos)
        fail();
    GcodeStatus status;
    status.state = line.substr(1, line.find_first_of("|:") - 1);  // "Hold:0" is Hold
    const std::vector<double> numbers =
        numbers_in(line.substr(position + std::string(kPosition).size()));
    if (numbers.size() < 2)
        fail();
    status.position_mm = {numbers[0], numbers[1]};
    return status;
}

GcodeStage::GcodeStage(const std::string& path, const ShouldStop& should_stop) : line_(path) {
    reset(should_stop);
    read_travel();
    home(should_stop);
}

void GcodeStage::silent(const std::string& expected) const {
    throw DeviceLost{"the stage does not answer", line_.path(), expected, "nothing"};
}

// Whatever it did for a program that died ends here; the greeting tells that it is a GRBL.
void GcodeStage::reset(const ShouldStop& should_stop) {
    line_.drop_input();
    line_.write(std::string(1, kReset));
    for (const double end_s = now_s() + kAnswer_s; now_s() < end_s;) {
        if (should_stop())
            throw Stopped{};
        const std::optional<std::string> line = line_.read_line(kLook_s);
        if (line && line->starts_with("Grbl ")) {
            version_ = line->substr(0, line->find(' ', 5));
            return;
        }
    }
    silent("a GRBL controller's greeting");
}

// $130 and $131 hold the travel of X and Y, mm.
void GcodeStage::read_travel() {
    line_.write("$$\n");
    for (const double end_s = now_s() + kAnswer_s; now_s() < end_s;) {
        const std::optional<std::string> line = line_.read_line(kLook_s);
        if (!line)
            continue;
        if (line->starts_with("$130="))
            travel_mm_.x = std::atof(line->c_str() + 5);
        if (line->starts_with("$131="))
            travel_mm_.y = std::atof(line->c_str() + 5);
        if (*line == "ok")
            return;
    }
    silent("its settings ($$)");
}

void GcodeStage::home(const ShouldStop& should_stop) {
    line_.write("$H\n");
    wait_for_ok("$H (homing)", kHoming_s, should_stop);
}

void GcodeStage::wait_for_ok(const std::string& command,
                             double patience_s,
                             const ShouldStop& should_stop) {
    for (const double end_s = now_s() + patience_s; now_s() < end_s;) {
        if (should_stop()) {
            line_.write(std::string(1, kHold));
            throw Stopped{};
        }
        const std::optional<std::string> line = line_.read_line(kLook_s);
        if (!line)
            continue;
        check_alarm(*line, line_.path());
        if (line->starts_with("error:"))
            throw Error{"the stage refuses", line_.path(), command, *line};
        if (*line == "ok")
            return;
    }
    silent("ok to " + command);
}

GcodeStatus GcodeStage::status() {
    line_.write(std::string(1, kStatus));
    for (const double end_s = now_s() + kAnswer_s; now_s() < end_s;) {
        const std::optional<std::string> line = line_.read_line(kLook_s);
        if (!line)
            continue;
        check_alarm(*line, line_.path());
        if (line->starts_with('<'))
            return gcode_status_from(*line, line_.path());
    }
    silent("its state (?)");
}

void GcodeStage::wait_until_idle(double patience_s, const ShouldStop& should_stop) {
    for (const double end_s = now_s() + patience_s;;) {
        const std::string state = status().state;
        if (state == "Idle")
            return;
        if (state != "Run")
            throw Error{"the stage stopped", line_.path(), "Idle after a move", state};
        if (now_s() > end_s)
            throw Error{"the stage does not arrive", line_.path(),
                        fmt::format("Idle within {:.0f} s", patience_s), state};
        if (should_stop()) {
            line_.write(std::string(1, kHold));
            throw Stopped{};
        }
        // Nothing is due but an alarm.
        if (const std::optional<std::string> line = line_.read_line(kLook_s))
            check_alarm(*line, line_.path());
    }
}

// The machine's coordinates run from 0 at the switches down to the travel, or up to it ($23):
// within the travel's length either way.
void GcodeStage::require_within_travel(glm::dvec2 position_mm) const {
    for (int k = 0; k < 2; ++k)
        if (travel_mm_[k] > 0 && std::abs(position_mm[k]) > travel_mm_[k])
            throw Error{
                "the stage cannot go there", line_.path(),
                fmt::format("{} within {:g} mm of the switch", k == 0 ? "X" : "Y", travel_mm_[k]),
                fmt::format("{:g} mm", position_mm[k])};
}

glm::dvec2 GcodeStage::move_to(glm::dvec2 position_mm,
                               double feed_mm_per_min,
                               double tolerance_mm,
                               const ShouldStop& should_stop) {
    require_within_travel(position_mm);
    const glm::dvec2 start_mm = status().position_mm;
    const std::string command = fmt::format("G21G90G94G53G1X{:.3f}Y{:.3f}F{:.0f}", position_mm.x,
                                            position_mm.y, feed_mm_per_min);
    line_.write(command + "\n");
    wait_for_ok(command, kAnswer_s, should_stop);
    const double way_mm = glm::length(position_mm - start_mm);
    wait_until_idle(20 + 4 * 60 * way_mm / feed_mm_per_min, should_stop);
    const glm::dvec2 got_mm = status().position_mm;
    if (!(glm::length(got_mm - position_mm) <= tolerance_mm))
        throw Error{"the stage stands elsewhere", line_.path(),
                    fmt::format("{:.3f}, {:.3f} mm within {:g}", position_mm.x, position_mm.y,
                                tolerance_mm),
                    fmt::format("{:.3f}, {:.3f} mm", got_mm.x, got_mm.y)};
    return got_mm;
}

}  // namespace nearfield::acquire
