// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "formats/files/json_field.h"
#include "formats/files/provenance.h"

namespace nearfield {

/// A provenance as it stands in every file. Throws Error where a figure is no finite number.
Json json_of(const Provenance& provenance);

/// The inverse of json_of.
Provenance provenance_from(const JsonField& root);

}  // namespace nearfield
