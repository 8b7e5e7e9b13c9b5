// SPDX-License-Identifier: Apache-2.0
#include "app/lamp_input.h"

#include "formats/photometry/photometric_file.h"

namespace nearfield::app {

farfield::LampView LampInput::view() const {
    return std::visit([](const auto& known) { return farfield::view_of(known); }, lamp);
}

LampInput read_lamp(const std::string& path) {
    if (photometry::holds_photometry(path))
        return {photometry::read_photometry(path)};
    return {read_lightfield(path)};
}

}  // namespace nearfield::app
