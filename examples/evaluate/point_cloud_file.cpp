// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/point_cloud_file.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace hmcdyn::evaluate {
namespace {

struct Property {
  std::string type;
  std::string name;
};

struct Header {
  bool is_ascii = false;
  std::size_t vertices = 0;
  std::vector<Property> properties;  // of a vertex
};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw std::runtime_error(file.string() + ": " + what);
}

std::size_t sizeOf(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes{
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

void readFormat(const std::filesystem::path& file, std::istringstream& fields, Header& header) {
  std::string format;
  fields >> format;
  if (format != "ascii" && format != "binary_little_endian") {
    fail(file, "PLY format '" + format + "'; expected ascii or binary_little_endian");
  }
  header.is_ascii = format == "ascii";
}

Header readHeader(std::istream& stream, const std::filesystem::path& file) {
  Header header;
  bool has_format = false;
  std::string line;
  if (!std::getline(stream, line) || line.substr(0, 3) != "ply") {
    fail(file, "is no PLY file");
  }
  bool in_vertex = false;
  std::size_t elements = 0;
  while (std::getline(stream, line)) {
    std::istringstream fields(line);
    std::string word;
    fields >> word;
    if (word == "end_header") {
      if (!has_format) {
        fail(file, "its PLY header names no format");
      }
      return header;
    }
    if (word == "format") {
      has_format = true;
      readFormat(file, fields, header);
    } else if (word == "element") {
      std::string name;
      std::size_t count = 0;
      in_vertex = static_cast<bool>(fields >> name >> count) && name == "vertex";
      if (++elements == 1 && !in_vertex) {
        fail(file, "its first element is '" + name + "'; expected vertex and a count");
      }
      header.vertices = in_vertex ? count : header.vertices;
    } else if (word == "property" && in_vertex) {
      Property property;
      fields >> property.type >> property.name;
      if (sizeOf(property.type) == 0) {
        fail(file, "a vertex has a property of type '" + property.type + "'; expected a scalar");
      }
      header.properties.push_back(property);
    }
  }
  fail(file, "its PLY header has no end");
}

/// Index of the property in a vertex; it must be a float or double.
std::size_t findCoordinate(const Header& header, const char* name,
                           const std::filesystem::path& file) {
  for (std::size_t i = 0; i < header.properties.size(); ++i) {
    const Property& property = header.properties[i];
    if (property.name == name && property.type.find_first_of("fd") == 0) {
      return i;
    }
  }
  fail(file, std::string("its vertices have no float or double '") + name + "'");
}

/// A little-endian number, whatever the machine.
float decode(const char* bytes, std::size_t size) {
  std::uint64_t bits = 0;
  for (std::size_t i = size; i-- > 0;) {
    bits = bits << 8U | static_cast<unsigned char>(bytes[i]);
  }
  if (size == sizeof(float)) {
    const auto narrow = static_cast<std::uint32_t>(bits);
    float value = 0.0f;
    std::memcpy(&value, &narrow, sizeof value);
    return value;
  }
  double value = 0.0;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<float>(value);
}

Eigen::Vector3f readVertex(std::istream& stream, const Header& header,
                           const std::array<std::size_t, 3>& coordinate, std::string& buffer) {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  std::size_t offset = 0;
  if (!header.is_ascii) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
  }
  for (std::size_t i = 0; i < header.properties.size(); ++i) {
    const std::size_t size = sizeOf(header.properties[i].type);
    float value = 0.0f;
    if (header.is_ascii) {
      std::string word;  // streams do not read "nan"
      stream >> word;
      char* end = nullptr;
      value = std::strtof(word.c_str(), &end);
      if (*end != '\0') {
        stream.setstate(std::ios::failbit);
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (coordinate[axis] == i) {
        position[static_cast<Eigen::Index>(axis)] =
            header.is_ascii ? value : decode(buffer.data() + offset, size);
      }
    }
    offset += size;
  }
  return position;
}

}  // namespace

std::vector<Eigen::Vector3f> readPlyPositions(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    fail(file, "cannot be read");
  }
  const Header header = readHeader(stream, file);
  const std::array<std::size_t, 3> coordinate{findCoordinate(header, "x", file),
                                              findCoordinate(header, "y", file),
                                              findCoordinate(header, "z", file)};
  std::size_t vertex_size = 0;
  for (const Property& property : header.properties) {
    vertex_size += sizeOf(property.type);
  }
  std::string buffer(vertex_size, '\0');
  std::vector<Eigen::Vector3f> positions;
  for (std::size_t i = 0; i < header.vertices; ++i) {
    const Eigen::Vector3f position = readVertex(stream, header, coordinate, buffer);
    if (!stream) {
      fail(file, "cut off or malformed after " + std::to_string(i) + " of " +
                     std::to_string(header.vertices) + " vertices");
    }
    if (position.allFinite()) {
      positions.push_back(position);
    }
  }
  return positions;
}

}  // namespace hmcdyn::evaluate
