// SPDX-License-Identifier: MIT
#include "scene/validate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <set>

#include "scene/key_table.h"

namespace verisim::scene {
namespace {

bool is_identifier(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
}

// Levenshtein distance, for "did you mean".
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

// The part of a key before its unit: gravity of gravity_m_s2, sphere_radius of sphere_radius_cm.
std::string stem(const std::string& name) {
  static const std::set<std::string> units = {"m",  "cm", "mm", "s",  "ms", "us",  "hz", "n",
                                              "kg", "g",  "m3", "m2", "s2", "rad", "deg"};
  std::string text = name;
  for (;;) {
    const std::size_t underscore = text.rfind('_');
    if (underscore == std::string::npos || !units.contains(text.substr(underscore + 1))) {
      return text;
    }
    text.resize(underscore);
  }
}

class Validator {
 public:
  explicit Validator(const Document& document) : document_(document) {}

  std::vector<Problem> run() {
    check_map(scene_keys(), document_.root, "");
    return std::move(problems_);
  }

 private:
  static std::string join(const std::string& path, const std::string& name) {
    return path.empty() ? name : path + "." + name;
  }

  void add(const std::string& path, const YAML::Node& node, std::string seen, std::string allowed,
           std::string hint = "") {
    problems_.push_back(
        {document_.where(path, node), path, std::move(seen), std::move(allowed), std::move(hint)});
  }

  void wrong_kind(const Key& key, const YAML::Node& node, const std::string& path) {
    const bool numeric =
        key.kind == Kind::kNumber || key.kind == Kind::kInteger || key.kind == Kind::kVector;
    add(path, node, one_line(node), allowed_text(key),
        numeric ? "write plain numbers; the unit is part of the key" : "");
  }

  void unknown_key(const Key& map, const YAML::Node& node, const std::string& path,
                   const std::string& name) {
    const Key* nearest = nullptr;
    std::size_t best = 4;
    for (const Key& child : map.children) {
      const std::size_t distance =
          stem(child.name) == stem(name) ? 0 : edit_distance(child.name, name);
      if (distance < best) {
        best = distance;
        nearest = &child;
      }
    }
    std::string hint;
    if (nearest != nullptr) {
      hint = "did you mean " + nearest->name + "? Units are fixed by the key";
    } else if (path.empty() && (name == "edits" || name == "version")) {
      hint = "this version of Verisim does not model it";
    }
    std::string allowed = "one of:";
    for (const Key& child : map.children) allowed += " " + child.name;
    add(join(path, name), node, "an unknown key", allowed, hint);
  }

  void check_map(const Key& key, const YAML::Node& node, const std::string& path) {
    if (!node.IsMap()) return wrong_kind(key, node, path);
    std::set<std::string> seen;
    for (const auto& entry : node) {
      const std::string name = entry.first.IsScalar() ? entry.first.Scalar() : "?";
      if (!seen.insert(name).second) {
        add(join(path, name), entry.first, "the same key twice", "each key once");
        continue;
      }
      const auto child = std::find_if(key.children.begin(), key.children.end(),
                                      [&](const Key& k) { return k.name == name; });
      if (child == key.children.end()) {
        unknown_key(key, entry.first, path, name);
      } else {
        check(*child, entry.second, join(path, name));
      }
    }
    check_required(key, node, path, seen);
  }

  void check_required(const Key& key, const YAML::Node& node, const std::string& path,
                      const std::set<std::string>& seen) {
    std::string names;
    int num_found = 0;
    for (const Key& child : key.children) {
      if (!child.required) continue;
      const bool found = seen.contains(child.name);
      num_found += found;
      names += (names.empty() ? "" : ", ") + child.name;
      if (!found && !key.exactly_one_of_required) {
        add(join(path, child.name), node, "nothing", allowed_text(child), child.description);
      }
    }
    if (key.exactly_one_of_required && num_found != 1) {
      add(path, node, one_line(node), "exactly one of: " + names);
    }
  }

  void check_number(const Key& key, const YAML::Node& node, const std::string& path) {
    const std::optional<double> number = parse_number(node);
    const bool whole = key.kind != Kind::kInteger || (number && std::floor(*number) == *number);
    if (!number || !whole) return wrong_kind(key, node, path);
    if ((key.above && !(*number > *key.above)) || (key.at_least && !(*number >= *key.at_least)) ||
        (key.at_most && !(*number <= *key.at_most))) {
      add(path, node, one_line(node), allowed_text(key));
    }
  }

  void check_vector(const Key& key, const YAML::Node& node, const std::string& path) {
    if (!node.IsSequence() || node.size() != static_cast<std::size_t>(key.length)) {
      return wrong_kind(key, node, path);
    }
    for (const auto& item : node) {
      const std::optional<double> number = parse_number(item);
      if (!number || (key.above && !(*number > *key.above))) return wrong_kind(key, node, path);
    }
  }

  void check_list(const Key& key, const YAML::Node& node, const std::string& path) {
    if (!node.IsSequence()) return wrong_kind(key, node, path);
    for (std::size_t i = 0; i < node.size(); ++i) {
      const YAML::Node item = node[i];
      const bool named = item.IsMap() && item["name"] && item["name"].IsScalar();
      const std::string name = named ? item["name"].Scalar() : std::to_string(i);
      check_map(key, item, join(path, name));
    }
  }

  void check(const Key& key, const YAML::Node& node, const std::string& path) {
    const bool is_text = node.IsScalar() && !node.Scalar().empty();
    switch (key.kind) {
      case Kind::kNumber:
      case Kind::kInteger:
        return check_number(key, node, path);
      case Kind::kText:
      case Kind::kPath:
        if (!is_text) wrong_kind(key, node, path);
        return;
      case Kind::kIdentifier:
        if (!node.IsScalar() || !is_identifier(node.Scalar())) wrong_kind(key, node, path);
        return;
      case Kind::kVector:
        return check_vector(key, node, path);
      case Kind::kChoiceOrMap:
        if (node.IsMap()) return check_map(key, node, path);
        [[fallthrough]];
      case Kind::kChoice:
        if (!node.IsScalar() ||
            std::find(key.choices.begin(), key.choices.end(), node.Scalar()) == key.choices.end()) {
          wrong_kind(key, node, path);
        }
        return;
      case Kind::kMap:
        return check_map(key, node, path);
      case Kind::kNamedMap:
        if (!node.IsMap()) return wrong_kind(key, node, path);
        for (const auto& entry : node) {
          check_map(key, entry.second, join(path, entry.first.Scalar()));
        }
        return;
      case Kind::kList:
        return check_list(key, node, path);
      case Kind::kNameList:
        if (!node.IsSequence()) return wrong_kind(key, node, path);
        for (const auto& item : node) {
          if (!item.IsScalar()) return wrong_kind(key, node, path);
        }
        return;
    }
  }

  const Document& document_;
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> validate(const Document& document) { return Validator(document).run(); }

std::optional<double> parse_number(const YAML::Node& node) {
  // A quoted "4" is text, not a number: yaml-cpp tags it "!".
  if (!node.IsScalar() || node.Tag() == "!") return std::nullopt;
  const std::string& text = node.Scalar();
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  double number = 0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
    return std::nullopt;
  }
  return number;
}

}  // namespace verisim::scene
