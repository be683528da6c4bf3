// SPDX-License-Identifier: MIT
//! The scene as read, the timed loop of frames, poses and result written: peer.h in Rust.

use serde_json::{json, Value};
use std::error::Error;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Position, orientation (w first), velocity, angular velocity; world frame.
pub type State = [f64; 13];

const REHEARSE_UP_TO: usize = 200; // bodies; a step of more takes longer than what it warms
const REHEARSAL_S: f64 = 0.02; // of the processor; a page fault or a lazy symbol takes 1e-6

pub struct Body {
    pub is_free: bool,
    pub kind: String,
    pub half_extents: [f32; 3],
    pub radius: f32,
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub centres: Vec<[f32; 3]>,
    pub material: usize,
    pub mass: f32,
    pub inertia: [f32; 3],
    pub start: State,
}

pub struct Plane {
    pub normal: [f32; 3],
    pub offset: f32,
    pub material: usize,
}

pub struct Scene {
    pub config: String,
    pub gravity: [f32; 3],
    pub dt: f64,
    pub steps_per_frame: usize,
    pub num_frames: usize,
    pub warm_up_frames: usize,
    pub time_limit_s: f64,
    pub planes: Vec<Plane>,
    pub bodies: Vec<Body>,
    pub restitution: Vec<Vec<f32>>,
    pub friction: Vec<Vec<f32>>,
}

pub trait World {
    fn new(scene: &Scene) -> Result<Self>
    where
        Self: Sized;
    fn step(&mut self);
    fn state(&self, body: usize) -> State;
}

fn field<T: serde::de::DeserializeOwned>(value: &Value, key: &str) -> Result<T> {
    let item = value
        .get(key)
        .ok_or_else(|| format!("scene.json: no {key}"))?;
    Ok(serde_json::from_value(item.clone())?)
}

pub fn read_scene(file: &Path) -> Result<Scene> {
    let data: Value = serde_json::from_slice(&fs::read(file)?)?;
    let mut planes = Vec::new();
    for item in data["planes"].as_array().ok_or("scene.json: no planes")? {
        planes.push(Plane {
            normal: field(item, "normal")?,
            offset: field(item, "offset")?,
            material: field(item, "material")?,
        });
    }
    let mut bodies = Vec::new();
    for item in data["bodies"].as_array().ok_or("scene.json: no bodies")? {
        let shape = &item["shape"];
        let mut start: State = [0.0; 13];
        start[0..3].copy_from_slice(&field::<[f64; 3]>(item, "position")?);
        start[3..7].copy_from_slice(&field::<[f64; 4]>(item, "orientation_wxyz")?);
        start[7..10].copy_from_slice(&field::<[f64; 3]>(item, "linear_velocity")?);
        start[10..13].copy_from_slice(&field::<[f64; 3]>(item, "angular_velocity")?);
        bodies.push(Body {
            is_free: item["motion"] == "free",
            kind: field(shape, "kind")?,
            half_extents: field(shape, "half_extents")?,
            radius: field(shape, "radius")?,
            vertices: field(shape, "vertices")?,
            triangles: field(shape, "triangles")?,
            centres: field(shape, "centres")?,
            material: field(item, "material")?,
            mass: field(item, "mass")?,
            inertia: field(item, "inertia")?,
            start,
        });
    }
    Ok(Scene {
        config: field(&data, "config")?,
        gravity: field(&data, "gravity")?,
        dt: field(&data, "dt_s")?,
        steps_per_frame: field(&data, "steps_per_frame")?,
        num_frames: field(&data, "num_frames")?,
        warm_up_frames: field(&data, "warm_up_frames")?,
        time_limit_s: field(&data, "time_limit_s")?,
        planes,
        bodies,
        restitution: field(&data, "restitution")?,
        friction: field(&data, "friction")?,
    })
}

/// CPU time of this process, s.
fn cpu_seconds() -> f64 {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanoseconds: i64,
    }
    extern "C" {
        fn clock_gettime(clock: i32, now: *mut Timespec) -> i32;
    }
    const CLOCK_PROCESS_CPUTIME_ID: i32 = 2;
    let mut now = Timespec {
        seconds: 0,
        nanoseconds: 0,
    };
    // SAFETY: the struct is Linux's timespec on 64-bit machines.
    unsafe { clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &mut now) };
    now.seconds as f64 + 1e-9 * now.nanoseconds as f64
}

/// Steps a world that is thrown away, so that the timed one finds code and libraries loaded.
fn rehearse<W: World>(scene: &Scene) -> Result<()> {
    let mut world = W::new(scene)?;
    let end = cpu_seconds() + REHEARSAL_S;
    for _ in 0..scene.num_frames * scene.steps_per_frame {
        world.step();
        if cpu_seconds() > end {
            break;
        }
    }
    Ok(())
}

/// Steps a world through the scene, timed from the end of the warm-up to the last frame with the
/// copies of the poses of each frame, and writes what came of it.
pub fn run<W: World>(scene: &Scene, folder: &Path, version: &str) -> Result<()> {
    if scene.bodies.len() <= REHEARSE_UP_TO {
        rehearse::<W>(scene)?;
    }
    let mut world = W::new(scene)?;
    let num_bodies = scene.bodies.len();
    let mut states: Vec<State> = vec![[0.0; 13]; num_bodies * (scene.num_frames + 1)];
    for (state, body) in states.iter_mut().zip(&scene.bodies) {
        *state = body.start;
    }
    states
        .iter_mut()
        .skip(num_bodies)
        .for_each(|state| state[0] = 1.0); // touches the pages
    let mut failed: Option<String> = None;
    let mut frame = 0;
    let started = Instant::now();
    let mut cpu_start = cpu_seconds();
    while frame < scene.num_frames && failed.is_none() {
        if frame == scene.warm_up_frames {
            cpu_start = cpu_seconds();
        }
        for _ in 0..scene.steps_per_frame {
            world.step();
        }
        let (before, after) = states.split_at_mut(num_bodies);
        let row = &mut after[num_bodies * frame..num_bodies * (frame + 1)];
        for (i, state) in row.iter_mut().enumerate() {
            *state = if scene.bodies[i].is_free {
                world.state(i)
            } else {
                before[i]
            };
            if !state.iter().sum::<f64>().is_finite() {
                failed = Some("numbers that are not finite".into());
            }
        }
        if failed.is_none() {
            frame += 1;
            if frame < scene.num_frames && started.elapsed().as_secs_f64() > scene.time_limit_s {
                failed = Some(format!("time limit of {} s", scene.time_limit_s));
            }
        }
    }
    let cpu = cpu_seconds() - cpu_start;
    let frame_s = scene.dt * scene.steps_per_frame as f64;
    let failed = failed.map(|what| format!("{what} at {} s", frame as f64 * frame_s));

    let mut poses = std::io::BufWriter::new(fs::File::create(folder.join("poses.bin"))?);
    for value in states[..num_bodies * (frame + 1)].iter().flatten() {
        poses.write_all(&value.to_le_bytes())?;
    }
    poses.flush()?;
    let timed = frame.saturating_sub(scene.warm_up_frames);
    let result = json!({
        "cpu_s": if timed > 0 { cpu } else { 0.0 },
        "simulated_s": timed as f64 * frame_s,
        "version": version,
        "failed": failed,
    });
    Ok(fs::write(folder.join("result.json"), result.to_string())?)
}
