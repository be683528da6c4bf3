// SPDX-License-Identifier: MIT
#include "scene/document.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>

namespace verisim::scene {
namespace {

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts;
  std::stringstream stream(path);
  for (std::string part; std::getline(stream, part, '.');) parts.push_back(part);
  return parts;
}

bool is_within(const std::string& path, const std::string& outer) {
  return path == outer ||
         (path.size() > outer.size() && path.starts_with(outer) && path[outer.size()] == '.');
}

std::string names_in(const YAML::Node& list) {
  std::string names;
  for (const auto& item : list) {
    if (item.IsMap() && item["name"]) {
      names += (names.empty() ? "" : ", ") + item["name"].Scalar();
    }
  }
  return names;
}

// The item of a list that carries this name or index; an undefined node when there is none.
YAML::Node item_of(const YAML::Node& list, const std::string& part) {
  for (const auto& item : list) {
    if (item.IsMap() && item["name"] && item["name"].IsScalar() && item["name"].Scalar() == part) {
      return item;
    }
  }
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error == std::errc() && end == part.data() + part.size() && index < list.size()) {
    return list[index];
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

void apply(const Override& change, const YAML::Node& root, std::vector<Problem>& problems) {
  const std::string where = "--set " + change.path + "=" + change.text;
  YAML::Node value;
  try {
    value = YAML::Load(change.text);
  } catch (const YAML::Exception& error) {
    problems.push_back({where, change.path, change.text, "a YAML value", error.msg});
    return;
  }
  const std::vector<std::string> parts = split_path(change.path);
  YAML::Node node = root;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool is_last = i + 1 == parts.size();
    if (node.IsSequence()) {
      YAML::Node item = item_of(node, parts[i]);
      if (!item.IsDefined()) {
        problems.push_back({where, change.path, "'" + parts[i] + "'",
                            "a name or an index from this list: " + names_in(node), ""});
        return;
      }
      if (is_last) {
        item = value;
        return;
      }
      node.reset(item);
    } else if (node.IsMap() || node.IsNull()) {
      if (is_last) {
        node[parts[i]] = value;
        return;
      }
      if (!node[parts[i]]) node[parts[i]] = YAML::Node(YAML::NodeType::Map);
      node.reset(node[parts[i]]);
    } else {
      problems.push_back({where, change.path, "'" + parts[i] + "' inside a plain value",
                          "a path to an existing key", ""});
      return;
    }
  }
}

YAML::Node parse_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw SceneError({{file.string(), "scene", "no such file that can be read", "a YAML scene file",
                       "check the path; it is relative to the current folder"}});
  }
  try {
    return YAML::Load(stream);
  } catch (const YAML::Exception& error) {
    const int line = error.mark.line + 1;
    throw SceneError({{file.string() + ":" + std::to_string(line), "scene", "broken YAML",
                       "a YAML map", error.msg}});
  }
}

}  // namespace

std::string Document::where(const std::string& path, const YAML::Node& node) const {
  for (auto change = overrides.rbegin(); change != overrides.rend(); ++change) {
    if (is_within(path, change->path)) return "--set " + change->path + "=" + change->text;
  }
  const int line = node.IsDefined() ? node.Mark().line : -1;
  return line < 0 ? file.string() : file.string() + ":" + std::to_string(line + 1);
}

Document read_document(const std::filesystem::path& file,
                       const std::vector<std::string>& overrides) {
  Document document{file, parse_file(file), {}};
  std::vector<Problem> problems;
  if (!document.root.IsMap()) {
    problems.push_back({file.string() + ":1", "scene", one_line(document.root), "a map of keys",
                        "a scene starts with 'schema: 1'"});
    throw SceneError(std::move(problems));
  }
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      problems.push_back(
          {"--set " + text, "--set", text, "path=value", "for example --set physics.dt_s=1e-4"});
      continue;
    }
    document.overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
    apply(document.overrides.back(), document.root, problems);
  }
  if (!problems.empty()) throw SceneError(std::move(problems));
  return document;
}

std::string one_line(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return "nothing";
  YAML::Emitter emitter;
  emitter.SetSeqFormat(YAML::Flow);
  emitter.SetMapFormat(YAML::Flow);
  emitter << node;
  std::string text = emitter.c_str();
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

}  // namespace verisim::scene
