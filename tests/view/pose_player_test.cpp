// SPDX-License-Identifier: MIT
// Playing a pose log, and the meter beside it.
#include "view/pose_player.h"

#include <doctest/doctest.h>

#include "view/rate_meter.h"

using namespace verisim;

namespace {

/// Two bodies, frames 1/60 s apart; body 0 stands at x = frame.
view::PosePlayer player_of(int num_frames) {
  dem::PoseLog log;
  log.names = {"a", "b"};
  for (int i = 0; i < num_frames; ++i) {
    log.times.push_back(i / 60.0);
    log.poses.resize(log.poses.size() + 2);
    log.poses[2 * i].position.x() = i;
  }
  return view::PosePlayer(log);
}

}  // namespace

TEST_CASE("a_player_shows_the_frame_whose_time_has_come") {
  view::PosePlayer player = player_of(10);
  player.advance(0.9 / 60);
  CHECK(player.frame() == 0);
  player.advance(0.2 / 60);
  CHECK(player.frame() == 1);
  CHECK(player.poses().size() == 2);
  CHECK(player.poses()[0].position.x() == 1);
}

TEST_CASE("a_frame_is_not_lost_to_rounding") {
  view::PosePlayer player = player_of(100);
  // The sum of six intervals is a rounding short of 6 / 60 s, and so are many after it.
  for (int i = 1; i < 100; ++i) {
    player.advance(1 / 60.0);
    CHECK(player.frame() == i);
  }
}

TEST_CASE("a_player_stays_within_its_log") {
  view::PosePlayer player = player_of(10);
  player.step(-1);
  CHECK(player.frame() == 0);
  player.advance(1e9);
  CHECK(player.at_end());
  CHECK(player.frame() == 9);
  player.step(3);
  CHECK(player.frame() == 9);
  player.seek(4);
  player.advance(1.05 / 60);
  CHECK(player.frame() == 5);
}

TEST_CASE("the_meter_counts_the_last_second") {
  view::RateMeter meter;
  for (int i = 0; i < 50; ++i) meter.add(0.1, 0.05);
  CHECK(meter.frames_per_second() == doctest::Approx(10));
  CHECK(meter.real_time_factor() == doctest::Approx(0.5));
  for (int i = 0; i < 100; ++i) meter.add(0.02, 0.02);
  CHECK(meter.frames_per_second() == doctest::Approx(50));
  CHECK(meter.real_time_factor() == doctest::Approx(1));
}
