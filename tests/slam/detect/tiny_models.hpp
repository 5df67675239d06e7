// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace hmcdyn::test {

// Networks of one layer whose output follows by hand from the image's mean colour.

/// Numbers as the bytes that a model file holds.
template <class Number>
std::string bytesOf(const std::vector<Number>& numbers) {
  std::string bytes(numbers.size() * sizeof(Number), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

/// A Darknet network with one candidate for an image of 32 x 32 pixels, which looks at the upper
/// left pixel only. Its box is centred and has half the image's width and a quarter of its height.
/// `classes` + 5 filters.
inline std::string tinyDarknetCfg(int classes = 80) {
  return "[net]\nwidth = 32\nheight=32\nchannels=3\n\n"
         "[convolutional]\nfilters=" +
         std::to_string(classes + 5) +
         "\nsize=1\nstride=32\npad=0\nactivation=linear\n\n"
         "[yolo]\nmask=0\nanchors=16,8\nclasses=" +
         std::to_string(classes) + "\nnum=1\n";
}

/// Its weights: a person (class 0) where the pixel is red, a car (2) where it is blue, each with
/// the probability 0.9 under the given objectness.
inline std::string tinyDarknetWeights(double objectness, int classes = 80) {
  const auto logit = [](double p) { return static_cast<float>(std::log(p / (1.0 - p))); };
  constexpr float kNever = -20.0f;
  const std::size_t filters = static_cast<std::size_t>(classes) + 5;
  std::vector<float> biases(filters, kNever);
  std::vector<float> kernels(filters * 3, 0.0f);  // red, green, blue of each filter
  for (std::size_t i = 0; i < 4; ++i) {
    biases[i] = 0.0f;  // x and y in the middle of the cell, width and height of the anchor
  }
  biases[4] = logit(objectness);
  kernels[(5 + 0) * 3 + 0] = logit(0.9) - kNever;
  kernels[(5 + 2) * 3 + 2] = logit(0.9) - kNever;
  return bytesOf<std::int32_t>({0, 2, 0}) + bytesOf<std::int64_t>({0}) + bytesOf(biases) +
         bytesOf(kernels);
}

/// Just enough of Protocol Buffers' wire format, and of ONNX's messages, to write a model.
namespace onnx {

inline std::string varint(std::uint64_t value) {
  std::string bytes;
  for (; value > 0x7F; value >>= 7U) {
    bytes += static_cast<char>((value & 0x7FU) | 0x80U);
  }
  return bytes + static_cast<char>(value);
}
inline std::string field(unsigned number, std::uint64_t value) {
  return varint(number << 3U) + varint(value);
}
inline std::string field(unsigned number, const std::string& bytes) {
  return varint(number << 3U | 2U) + varint(bytes.size()) + bytes;
}
inline std::string floatTensor(const std::string& name, const std::vector<std::uint64_t>& dims,
                               const std::vector<float>& values) {
  std::string tensor;
  for (const std::uint64_t dim : dims) {
    tensor += field(1, dim);
  }
  return tensor + field(2, 1) + field(8, name) + field(9, bytesOf(values));
}
inline std::string integerTensor(const std::string& name, const std::vector<std::int64_t>& values) {
  return field(1, values.size()) + field(2, 7) + field(8, name) + field(9, bytesOf(values));
}
inline std::string integersAttribute(const std::string& name,
                                     const std::vector<std::uint64_t>& values) {
  std::string attribute = field(1, name);
  for (const std::uint64_t value : values) {
    attribute += field(8, value);
  }
  return attribute + field(20, 7);
}
inline std::string node(const std::string& type, const std::vector<std::string>& inputs,
                        const std::string& output, const std::string& attribute = {}) {
  std::string bytes;
  for (const std::string& input : inputs) {
    bytes += field(1, input);
  }
  bytes += field(2, output) + field(3, type + "_" + output) + field(4, type);
  return attribute.empty() ? bytes : bytes + field(5, attribute);
}
inline std::string value(const std::string& name, const std::vector<std::uint64_t>& dims) {
  std::string shape;
  for (const std::uint64_t dim : dims) {
    shape += field(1, field(1, dim));
  }
  return field(1, name) + field(2, field(1, field(1, 1) + field(2, shape)));
}

}  // namespace onnx

/// An ONNX network on 3 x 64 x 64 images: `size` numbers in the given shape, each a bias plus the
/// mean red, green and blue (0..1) times their kernel (3 numbers each).
/// @param last_node the operator that gives the output its shape; anything else than "Reshape"
/// makes a network that no importer knows.
inline std::string tinyOnnx(const std::vector<std::int64_t>& shape,
                            const std::vector<float>& biases, const std::vector<float>& kernels,
                            const std::string& last_node = "Reshape") {
  const std::uint64_t size = biases.size();
  const std::string graph =
      onnx::field(1, onnx::node("GlobalAveragePool", {"images"}, "mean")) +
      onnx::field(1, onnx::node("Conv", {"mean", "kernels", "biases"}, "flat",
                                onnx::integersAttribute("kernel_shape", {1, 1}))) +
      onnx::field(1, onnx::node(last_node, {"flat", "shape"}, "output0")) +
      onnx::field(2, std::string("tiny")) +
      onnx::field(5, onnx::floatTensor("kernels", {size, 3, 1, 1}, kernels)) +
      onnx::field(5, onnx::floatTensor("biases", {size}, biases)) +
      onnx::field(5, onnx::integerTensor("shape", shape)) +
      onnx::field(11, onnx::value("images", {1, 3, 64, 64})) +
      onnx::field(12, onnx::value("output0", {shape.begin(), shape.end()}));
  return onnx::field(1, std::uint64_t{7}) + onnx::field(7, graph) +
         onnx::field(8, onnx::field(2, std::uint64_t{12}));
}

}  // namespace hmcdyn::test
