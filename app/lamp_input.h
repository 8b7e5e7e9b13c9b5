// SPDX-License-Identifier: Apache-2.0
/// A lamp that a command is given: a light field or luminaire of ours, or a photometric file.
#pragma once

#include "formats/farfield/lamp_view.h"

#include <memory>
#include <string>
#include <variant>

namespace nearfield::app {

struct LampInput {
    std::variant<LightField, photometry::Photometry> lamp;

    farfield::LampView view() const;
};

/// Told by content. Throws Error as the readers do.
LampInput read_lamp(const std::string& path);

}  // namespace nearfield::app
