// SPDX-License-Identifier: Apache-2.0
/// What `nearfield info` says of a file, as text and as JSON (a contract: docs/formats.md, "info
/// --json").
#pragma once

#include "formats/files/image.h"
#include "formats/files/lightfield.h"
#include "formats/model/tables.h"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>

namespace nearfield::app {

/// kind, format_version, quantity, slabs, flux {value, unit, sigma}, provenance; "tables" where
/// verified.
nlohmann::ordered_json describe(const LightField& lightfield,
                                const FileKind& kind,
                                const std::optional<model::TableCheck>& tables);

/// kind "picture": size_px, layers, provenance.
nlohmann::ordered_json describe(const Picture& picture);

/// program, command; options and figures by name; inputs: the same of every kind.
nlohmann::ordered_json describe(const Provenance& provenance);

/// The same for people, from the JSON.
std::string as_text(const nlohmann::ordered_json& description);

}  // namespace nearfield::app
