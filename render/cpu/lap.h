// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/provenance.h"

namespace nearfield::render {

/// Tells apart what the stages of one thread's work take.
class Lap {
  public:
    /// Since the last call, or since it was made.
    double time_s() {
        const double before_s = at_s_;
        at_s_ = now_s();
        return at_s_ - before_s;
    }

  private:
    double at_s_ = now_s();
};

}  // namespace nearfield::render
