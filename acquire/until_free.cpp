// SPDX-License-Identifier: Apache-2.0
#include "acquire/until_free.h"

#include "formats/files/provenance.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

namespace nearfield::acquire {

void Patience::wait_after(const DeviceBusy& busy) {
    constexpr std::chrono::milliseconds kBetweenTries{20};
    if (!end_s_) {
        end_s_ = now_s() + patience_s_;
        say_(fmt::format("{}; waiting up to {:g} s for it", busy.what(), patience_s_));
    } else if (now_s() > *end_s_) {
        throw DeviceBusy{busy.what_, busy.where,
                         fmt::format("it to be free within {:g} s", patience_s_), busy.got};
    }
    if (should_stop_())
        throw Stopped{};
    std::this_thread::sleep_for(kBetweenTries);
}

}  // namespace nearfield::acquire
