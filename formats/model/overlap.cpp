// SPDX-License-Identifier: Apache-2.0
#include "formats/model/overlap.h"

#include "formats/model/profile.h"

namespace nearfield::model {

double overlap(const Profile& profile) {
    double sum = 0;
    const int reach = static_cast<int>(profile.cells.size());
    for (int k = -reach; k <= reach; ++k)
        sum += eval(profile, k);
    return sum;
}

}  // namespace nearfield::model
