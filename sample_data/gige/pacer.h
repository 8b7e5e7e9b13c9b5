// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <thread>

namespace nearfield::gige {

/// Spreads packets over time: a link of some speed, and the delay that a client asks for.
struct Pacer {
    using Clock = std::chrono::steady_clock;

    double ns_per_byte = 0;  // 0: no limit
    Clock::time_point due;   // when the link has sent all that it was given

    /// Waits until the next packet may go. Without a delay packets may run ahead of the link by a
    /// burst, so that the thread need not sleep between any two; late ones catch up by as much.
    void wait(std::size_t bytes, std::uint32_t delay_ns) {
        using std::chrono::nanoseconds;
        constexpr nanoseconds kBurst(200'000);  // 25 kB of a gigabit link; sockets hold 200 kB
        if (ns_per_byte == 0 && delay_ns == 0)
            return;
        const Clock::time_point now = Clock::now();
        due = std::max(due, now - kBurst);
        if (due > now + (delay_ns > 0 ? nanoseconds(0) : kBurst))
            std::this_thread::sleep_until(due);
        due += nanoseconds(static_cast<std::int64_t>(ns_per_byte * static_cast<double>(bytes))) +
               nanoseconds(delay_ns);
    }
};

}  // namespace nearfield::gige
