// SPDX-License-Identifier: Apache-2.0
/// Frames that arrive whole, however busy the wire and this machine are.
#pragma once

#include "acquire/camera.h"

namespace nearfield::acquire {

/// Tries of one frame before the camera is at fault. Where a receiver is starved of time so that
/// every second frame is torn, eight in a row are one in 256.
constexpr int kMostTries = 8;

/// What `look` returns, which is called again where a frame of it was torn.
template <typename Look>
auto until_whole(const Look& look) {
    for (int attempt = 1; attempt < kMostTries; ++attempt) {
        try {
            return look();
        } catch (const IncompleteFrame&) {
            continue;
        }
    }
    return look();
}

/// A whole frame, to be looked at and not kept: nothing is noted of torn ones.
inline Exposed expose_whole(Camera& camera, const ShouldStop& should_stop) {
    return until_whole([&] { return camera.expose(should_stop); });
}

}  // namespace nearfield::acquire
