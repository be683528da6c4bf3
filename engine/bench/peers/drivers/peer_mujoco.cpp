// SPDX-License-Identifier: MIT
// MuJoCo through its C interface, on the model that mjcf.py writes beside the scene.
#include <mujoco/mujoco.h>

#include <memory>

#include "peer.h"

namespace {

std::string model_file;

class World {
 public:
  explicit World(const peer::Scene& scene) : joint_(scene.bodies.size()) {
    mju_user_warning = [](const char*) {};  // counted in mjData
    char message[1000] = "";
    model_.reset(mj_loadXML(model_file.c_str(), nullptr, message, sizeof message));
    if (!model_) throw std::runtime_error(message);
    data_.reset(mj_makeData(model_.get()));
    int joint = 0;
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
      const peer::Body& body = scene.bodies[i];
      if (!body.is_free) continue;
      joint_[i] = joint++;
      mjtNum* velocity = data_->qvel + model_->jnt_dofadr[joint_[i]];
      mju_copy3(velocity, body.linear_velocity.data());
      mjtNum inverse[4];
      mju_negQuat(inverse, body.orientation.data());
      mju_rotVecQuat(velocity + 3, body.angular_velocity.data(), inverse);
    }
    mj_forward(model_.get(), data_.get());
  }

  void step() { mj_step(model_.get(), data_.get()); }

  peer::State state(size_t i) const {
    const mjtNum* place = data_->qpos + model_->jnt_qposadr[joint_[i]];
    const mjtNum* velocity = data_->qvel + model_->jnt_dofadr[joint_[i]];
    peer::State state;
    mju_copy3(state.position.data(), place);
    mju_copy4(state.orientation.data(), place + 3);
    mju_copy3(state.linear_velocity.data(), velocity);
    mju_rotVecQuat(state.angular_velocity.data(), velocity + 3, place + 3);
    return state;
  }

  std::string version() const { return mj_versionString(); }

  /// MuJoCo starts the scene anew where its numbers go wrong, and drops contacts it has no room
  /// for.
  std::string failure() const {
    for (int kind : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      if (data_->warning[kind].number > 0) return "numbers that MuJoCo calls bad";
    if (data_->warning[mjWARN_CONTACTFULL].number > 0) return "no memory for contacts";
    if (data_->warning[mjWARN_CNSTRFULL].number > 0) return "no memory for constraints";
    return "";
  }

 private:
  struct Free {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Free> model_;
  std::unique_ptr<mjData, Free> data_;
  std::vector<int> joint_;  // of each body; free ones only
};

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2) model_file = std::string(argv[1]) + "/model.xml";
  return peer::run_main<World>(argc, argv);
}
