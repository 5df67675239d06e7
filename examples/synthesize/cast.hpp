// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

#include "synthesize/behaviour.hpp"
#include "synthesize/body.hpp"
#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

/// Adds a person to a scene. @return what the person does, for things that he or she holds.
inline std::shared_ptr<const Performance> addPerson(Scene& scene, const BodyLook& look,
                                                    const Behaviour& behaviour, double seconds) {
  auto performance = std::make_shared<const Performance>(behaviour, seconds);
  Mover person;
  person.parts = buildBody(scene.textures, look);
  person.poses = [performance, height = look.height](double time) {
    return bodyPoses(height, performance->at(time));
  };
  scene.movers.push_back(std::move(person));
  return performance;
}

}  // namespace hmcdyn::synthesize
