// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace nearfield {

using Json = nlohmann::ordered_json;  // keys in the order written: files are read by people too

/// A value in a JSON text, with its place for error messages: "lamp.exr,
/// nearfield.luminaire.slabs[0].delta_m". The readers throw Error where the value is missing or of
/// another kind.
class JsonField {
  public:
    JsonField(const Json& value, std::string where) : value_(&value), where_(std::move(where)) {}

    const std::string& where() const { return where_; }
    bool has(const std::string& key) const;
    /// Throws Error where an object has a key that is not among the known ones: a slip of the pen.
    void only(const std::vector<std::string>& known) const;
    JsonField at(const std::string& key) const;
    /// An object's keys.
    std::vector<std::string> keys() const;
    bool is_list() const;
    std::vector<JsonField> elements() const;
    std::vector<JsonField> elements(std::size_t count) const;

    double number() const;  // finite
    int integer(int least, int most) const;
    bool boolean() const;
    std::string text() const;
    std::vector<double> numbers(std::size_t count) const;

  private:
    [[noreturn]] void fail(const std::string& expected) const;
    const Json* value_;
    std::string where_;
};

/// Parses a text; where names it in errors.
Json parse_json(const std::string& text, const std::string& where);

/// The text of a document; bytes that are not UTF-8 are replaced. Doubles survive exactly (17
/// digits where needed).
std::string json_text(const Json& document);

}  // namespace nearfield
