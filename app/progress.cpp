// SPDX-License-Identifier: Apache-2.0
#include "app/progress.h"

#include "formats/files/provenance.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace nearfield::app {

ProgressLine::ProgressLine(std::string name)
    : name_(std::move(name)), start_s_(now_s()), visible_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
    finish();
}

void ProgressLine::update(double fraction, const std::string& state) {
    if (!visible_)
        return;
    const std::lock_guard lock(mutex_);
    const double now = now_s();
    if (drawn_ && now - drawn_s_ < 0.1)
        return;
    drawn_ = true;
    drawn_s_ = now;
    const double elapsed = now - start_s_;
    const std::string left =
        fraction > 0.02 ? fmt::format(", {:.0f} s left", elapsed * (1.0 - fraction) / fraction)
                        : "";
    fmt::print(stderr, "\r{}: {}{:3.0f} %, {:.0f} s{}\x1b[K", name_,
               state.empty() ? "" : state + ", ", 100.0 * fraction, elapsed, left);
    std::fflush(stderr);
}

void ProgressLine::finish() {
    const std::lock_guard lock(mutex_);
    if (drawn_) {
        fmt::print(stderr, "\r\x1b[K");
        std::fflush(stderr);
    }
    drawn_ = false;
}

}  // namespace nearfield::app
