// SPDX-License-Identifier: MIT
#include "scene/schema.h"

#include <nlohmann/json.hpp>

#include "scene/key_table.h"

namespace verisim::scene {
namespace {

using Json = nlohmann::ordered_json;

// Whole numbers print without a decimal point.
Json json_number(double value) {
  const auto whole = static_cast<long long>(value);
  if (static_cast<double>(whole) == value) return whole;
  return value;
}

void add_bounds(const Key& key, Json& node) {
  if (key.above) node["exclusiveMinimum"] = json_number(*key.above);
  if (key.at_least) node["minimum"] = json_number(*key.at_least);
  if (key.at_most) node["maximum"] = json_number(*key.at_most);
}

Json schema_of(const Key& key);

Json map_schema(const Key& key) {
  Json node{{"type", "object"}, {"additionalProperties", false}};
  Json required = Json::array();
  Json one_of = Json::array();
  for (const Key& child : key.children) {
    node["properties"][child.name] = schema_of(child);
    if (!child.required) continue;
    if (key.exactly_one_of_required) {
      one_of.push_back({{"required", Json::array({child.name})}});
    } else {
      required.push_back(child.name);
    }
  }
  if (!required.empty()) node["required"] = required;
  if (!one_of.empty()) node["oneOf"] = one_of;
  return node;
}

Json value_schema(const Key& key) {
  Json node;
  switch (key.kind) {
    case Kind::kNumber:
    case Kind::kInteger:
      node["type"] = key.kind == Kind::kNumber ? "number" : "integer";
      add_bounds(key, node);
      break;
    case Kind::kText:
    case Kind::kPath:
      node = {{"type", "string"}, {"minLength", 1}};
      break;
    case Kind::kIdentifier:
      node = {{"type", "string"}, {"pattern", "^[A-Za-z0-9_-]+$"}};
      break;
    case Kind::kVector: {
      Json item{{"type", "number"}};
      add_bounds(key, item);
      node = {
          {"type", "array"}, {"items", item}, {"minItems", key.length}, {"maxItems", key.length}};
      break;
    }
    case Kind::kChoice:
      node["enum"] = key.choices;
      break;
    case Kind::kMap:
      node = map_schema(key);
      break;
    case Kind::kNamedMap:
      node = {{"type", "object"},
              {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]+$"}}},
              {"additionalProperties", map_schema(key)}};
      break;
    case Kind::kList:
      node = {{"type", "array"}, {"items", map_schema(key)}};
      break;
    case Kind::kNameList:
      node = {{"type", "array"}, {"items", {{"type", "string"}}}};
      break;
    case Kind::kChoiceOrMap:
      node["oneOf"] = Json::array({Json{{"enum", key.choices}}, map_schema(key)});
      break;
  }
  return node;
}

Json schema_of(const Key& key) {
  Json node = value_schema(key);
  std::string description = key.description;
  if (!key.default_text.empty()) description += " Default: " + key.default_text + ".";
  if (!description.empty()) node["description"] = description;
  return node;
}

}  // namespace

std::string scene_schema() {
  Json root{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
            {"title", "Verisim scene"}};
  root.update(schema_of(scene_keys()));
  return root.dump(2) + "\n";
}

}  // namespace verisim::scene
