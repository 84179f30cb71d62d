// Scenes that the tests of this folder share.
#pragma once
#include <string>

namespace ballast::scene {

/// Every kind of thing that a scene can hold, apart from meshes.
inline const std::string kRich = R"(ballast: 1
description: "A bit of everything: all keys"
world: { gravity: [0, 0, -9.81], duration: 3 s, spacing: 2 cm, accuracy: accurate, periodic: [x, y],
  domain: { min: [-1, -1, -1], max: [3 m, 300 cm, 3000 mm] }, allow_overlap: true, seed: 18446744073709551615 }
fluids:
  - { name: water, material: water, fill: { box: { min: [0, 0, 0], max: [0.6, 0.6, 30 spacings] } },
      velocity: [1, 0, 0], angular_velocity: [0, 0, 30 deg/s] }
  - { name: oil, density: 900, viscosity: 0.1 Pa s, surface_tension: 30 mN/m, vortices: { speed: 0.5, wavelength: 2 m },
      fill: { level: { container: tank, z: 0.5 m } } }
models:
  - { name: tank, static: true, shape: { open_box: { inside: [1.6, 0.6, 1.2], wall: 5 cm, lid: true } } }
  - { name: crate, shape: { box: [0.12, 0.12, 0.12] }, density: 500 kg/m^3, pose: [1.1, 0.3, 0.06], friction: 0.3,
      restitution: 10 %, repeat: { count: [2, 1, 3], step: [0.12, 0, 0.13] } }
  - { name: ball, mass: 2 kg, shape: { sphere: { radius: 10 cm } }, pose: [1, 1, 1, 0, 30 deg, 0], velocity: [0, 0, 1] }
  - name: paddle
    shape:
      compound:
        - { shape: { cylinder: { radius: 0.1, length: 1 } }, pose: [0, 0, 1] }
        - { shape: { capsule: { radius: 0.1, length: 1 } }, pose: { rotation: [0.70711, 0, 0.70711, 0] } }
    prescribed: { velocity: [0.1, 0, 0], amplitude: [0, 0, 1], frequency: 2 Hz, phase: 90 deg, start: 1 s, stop: 2 s }
  - { name: floor, static: true, shape: { plane: { normal: [0, 0.6, 0.8] } } }
  - { name: bowl, static: true, shape: { hollow_sphere: { radius: 1, wall: 2 spacings } } }
  - { name: drum, static: true, shape: { hollow_cylinder: { radius: 1, length: 2 } } }
joints:
  - { name: hinge, type: revolute, parent: world, child: ball, anchor: [0, 0, 1], axis: [0, 1, 0],
      limits: { lower: -30 deg, upper: 0.5 }, motor: { velocity: 60 rpm, max_effort: 5 N m }, spring: 3 N m/rad,
      damper: 0.1 N m s/rad, rest: 5 deg }
  - { name: cross, type: universal, parent: ball, child: crate_0_0_0, axis: [0, 0, 1], axis2: [1, 0, 0] }
  - { name: slider, type: prismatic, parent: world, child: crate_1_0_2, limits: { upper: 2 }, spring: 3 N/m }
coupling: { engine: free_body, scheme: interlinked, substeps: 2, rigid_step: 2 ms, contact_sets: never }
numerics: { pressure: wcsph, kernel: wendland, support: 3.5, sound_speed: 30 m/s, courant: 0.2, diffusion: 0.05,
  relax: false, shifting: never, skip_search: false }
probes:
  - { name: front, level_at: [1.5, 0.3] }
  - { name: p1, pressure_at: [1.5, 0.3, 5 spacings] }
  - { name: tank, force_on: tank }
  - { name: top, pose_of: ball }
  - { name: err, pressure_error: water }
  - { name: motion, motion_of: oil }
  - { name: void, void_in: water }
output: { every: 20 ms, vtk: true, picture: true, camera: [1, 2, 3] }
expect:
  - lost_particles: 0
  - { moved: { models: "crate*", at_least: 6, by: 6 cm } }
  - { inside: { models: "*", container: tank } }
  - { column: { of: tank.fz, statistic: mean, from: 5 ms, to: 15 ms, equals: -100 N, within: 7 % } }
  - { column: { of: front, below: 1, above: 0.5 } }
  - { column: { of: ball.x, equals: 20 cm, within: 1 mm } }
  - { initial_acceleration: { model: ball, coefficient: 0.5, fluid: water, within: 4 %, from: 0.01, to: 0.02 } }
  - { jitter: { model: crate_0_0_0, below: 0.1 } }
  - { momentum: { below: 1e-12 } }
  - { track: { of: "top.x", reference: "file of a reference.csv", time_offset: 0.1, value_offset: 10 cm, below: 0.06 } }
)";

}  // namespace ballast::scene
