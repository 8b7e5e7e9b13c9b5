// SPDX-License-Identifier: Apache-2.0
#include "app/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>

namespace nearfield::app {
namespace {

std::atomic<bool> is_requested{false};  // a signal handler can reach nothing else

void request(int /*signal*/) {
    is_requested = true;
}

void watch(const std::stop_token& stop, const char* last_words) {
    using namespace std::chrono_literals;
    constexpr auto kGrace = 800ms;
    while (!is_requested && !stop.stop_requested())
        std::this_thread::sleep_for(20ms);
    const auto end = std::chrono::steady_clock::now() + kGrace;
    while (!stop.stop_requested() && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(20ms);
    if (stop.stop_requested())
        return;
    // Not by way of destructors: they would wait for the same driver.
    if (write(STDERR_FILENO, last_words, std::strlen(last_words)) < 0)
        _exit(kExitInterrupted);
    _exit(kExitInterrupted);
}

}  // namespace

Interrupt::Interrupt(const char* last_words) {
    is_requested = false;
    std::signal(SIGINT, request);
    std::signal(SIGTERM, request);
    watcher_ = std::jthread([last_words](const std::stop_token& stop) { watch(stop, last_words); });
}

Interrupt::~Interrupt() {
    watcher_.request_stop();
    watcher_.join();
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool Interrupt::requested() {
    return is_requested;
}

}  // namespace nearfield::app
