// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/scene/scene.h"
#include "render/plan.h"

namespace nearfield::render {

/// What the plan leaves of a material: no lobe without gloss, gray where color was removed.
shared::Brdf planned_brdf(const Material& material, const Plan& plan);

}  // namespace nearfield::render
