// SPDX-License-Identifier: MIT
//! Rapier in single precision.

mod scene;

use rapier3d::prelude::*;
use scene::{Body, Result, Scene, State};

/// Values by pair of materials, where the engine's own rules cannot give them.
struct PairValues {
    restitution: Vec<Vec<f32>>,
    friction: Vec<Vec<f32>>,
}

impl PhysicsHooks for PairValues {
    fn modify_solver_contacts(&self, context: &mut ContactModificationContext) {
        let a = context.colliders[context.collider1].user_data as usize;
        let b = context.colliders[context.collider2].user_data as usize;
        if let Some(contact) = context.rigid_mut() {
            *contact.restitution = self.restitution[a][b];
            *contact.friction = self.friction[a][b];
        }
    }
}

struct World {
    gravity: Vector,
    parameters: IntegrationParameters,
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd_solver: CCDSolver,
    hooks: Option<PairValues>,
    handles: Vec<RigidBodyHandle>,
}

fn parameters_of(scene: &Scene) -> Result<IntegrationParameters> {
    let mut parameters = IntegrationParameters {
        dt: scene.dt as f32,
        ..Default::default()
    };
    match scene.config.as_str() {
        "default" => {}
        "stiff" => {
            parameters.num_solver_iterations = 8;
            parameters.normalized_allowed_linear_error = 1e-4;
            let substep_rate = 8.0 / parameters.dt;
            parameters.contact_softness.natural_frequency = 0.25 * substep_rate;
            parameters.static_contact_softness.natural_frequency = 0.25 * substep_rate;
        }
        "16it+coulomb" => {
            parameters.num_solver_iterations = 16;
            parameters.normalized_allowed_linear_error = 1e-4;
            parameters.friction_model = FrictionModel::Coulomb;
            parameters.contact_recycling = false;
            parameters.contact_clustering = false;
        }
        other => return Err(format!("rapier has no configuration {other}").into()),
    }
    Ok(parameters)
}

/// Whether each pair has the geometric mean of what its materials have among themselves.
fn is_geometric_mean(table: &[Vec<f32>]) -> bool {
    (0..table.len()).all(|a| {
        (0..table.len()).all(|b| {
            let mean = (table[a][a] * table[b][b]).sqrt();
            (table[a][b] - mean).abs() <= 1e-6 * mean.max(1e-6)
        })
    })
}

fn shape_of(body: &Body) -> Result<SharedShape> {
    Ok(match body.kind.as_str() {
        "box" => {
            let [x, y, z] = body.half_extents;
            SharedShape::cuboid(x, y, z)
        }
        "sphere" => SharedShape::ball(body.radius),
        "mesh" => {
            let corners = body.vertices.iter().map(|corner| Vector::from(*corner)).collect();
            let hull = SharedShape::convex_mesh(corners, &body.triangles);
            hull.ok_or("rapier cannot take a mesh as convex")?
        }
        // One collider per sphere instead takes a hundred times as long.
        _ => SharedShape::compound(
            body.centres
                .iter()
                .map(|centre| {
                    let place = Pose::from_translation(Vector::from(*centre));
                    (place, SharedShape::ball(body.radius))
                })
                .collect(),
        ),
    })
}

impl scene::World for World {
    fn new(scene: &Scene) -> Result<World> {
        let by_rule = is_geometric_mean(&scene.restitution) && is_geometric_mean(&scene.friction);
        let mut world = World {
            gravity: Vector::from(scene.gravity),
            parameters: parameters_of(scene)?,
            pipeline: PhysicsPipeline::new(),
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            bodies: RigidBodySet::new(),
            colliders: ColliderSet::new(),
            impulse_joints: ImpulseJointSet::new(),
            multibody_joints: MultibodyJointSet::new(),
            soft_bodies: SoftBodySet::new(),
            ccd_solver: CCDSolver::new(),
            hooks: (!by_rule).then(|| PairValues {
                restitution: scene.restitution.clone(),
                friction: scene.friction.clone(),
            }),
            handles: Vec::new(),
        };
        let collider = |shape: SharedShape, material: usize| {
            let rule = CoefficientCombineRule::GeometricMean;
            let hooks = if by_rule {
                ActiveHooks::empty()
            } else {
                ActiveHooks::MODIFY_SOLVER_CONTACTS
            };
            ColliderBuilder::new(shape)
                .density(0.0)
                .friction(scene.friction[material][material])
                .restitution(scene.restitution[material][material])
                .friction_combine_rule(rule)
                .restitution_combine_rule(rule)
                .active_hooks(hooks)
                .user_data(material as u128)
        };
        for plane in &scene.planes {
            let normal = Vector::from(plane.normal);
            let place = Pose::from_translation(normal * plane.offset);
            let solid = collider(SharedShape::halfspace(normal), plane.material).position(place);
            world.colliders.insert(solid);
        }
        for body in &scene.bodies {
            let start = body.start.map(|value| value as f32);
            let place = Pose::from_parts(
                Vector::new(start[0], start[1], start[2]),
                Rotation::from_xyzw(start[4], start[5], start[6], start[3]).normalize(),
            );
            let builder = if body.is_free {
                let inertia = AngVector::from(body.inertia);
                RigidBodyBuilder::dynamic()
                    .linvel(Vector::new(start[7], start[8], start[9]))
                    .angvel(AngVector::new(start[10], start[11], start[12]))
                    .additional_mass_properties(MassProperties::new(
                        Vector::ZERO,
                        body.mass,
                        inertia,
                    ))
                    .can_sleep(false)
            } else {
                RigidBodyBuilder::fixed()
            };
            let handle = world.bodies.insert(builder.pose(place));
            let part = collider(shape_of(body)?, body.material);
            world.colliders.insert_with_parent(part, handle, &mut world.bodies);
            world.handles.push(handle);
        }
        Ok(world)
    }

    fn step(&mut self) {
        let hooks: &dyn PhysicsHooks = match &self.hooks {
            Some(hooks) => hooks,
            None => &(),
        };
        self.pipeline.step(
            self.gravity,
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd_solver,
            hooks,
            &(),
        );
    }

    fn state(&self, body: usize) -> State {
        let body = &self.bodies[self.handles[body]];
        let (x, q, v, w) = (
            body.translation(),
            body.rotation(),
            body.linvel(),
            body.angvel(),
        );
        [
            x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z,
        ]
        .map(f64::from)
    }
}

fn main() -> Result<()> {
    let folder = std::env::args_os()
        .nth(1)
        .ok_or("usage: peer_rapier FOLDER")?;
    let folder = std::path::Path::new(&folder);
    let scene = scene::read_scene(&folder.join("scene.json"))?;
    scene::run::<World>(&scene, folder, &format!("{} float32", rapier3d::VERSION))
}
