//! What every pixel sees in one pose: ray casting.

use isolux::{Plane, Shape, Window};

use crate::model::CameraModel;
use crate::scene::Scene;
use crate::scene::object::Object;
use crate::scene::pose::{Pose, RigidFrame, Vector, along, dot, normalized};

/// One pixel's share of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelView {
    /// Electrons per µs that the four bins receive on average.
    pub(crate) rates: [f64; 4],
    /// Linear amplitude per integration time, electrons per µs.
    pub(crate) amplitude_rate: f64,
    /// Radial distance, not wrapped; NaN where nothing is seen, as the next three.
    pub(crate) distance_m: f32,
    pub(crate) reflectivity: f32,
    pub(crate) cos_incidence: f32,
    /// `(ρ cosθ + highlight) v`.
    pub(crate) return_factor: f32,
    /// Share of the highlight in it.
    pub(crate) specular_fraction: f32,
    /// Calibration label.
    pub(crate) target: u8,
}

/// Everything in one pose.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) pixels: Plane<PixelView>,
    pub(crate) world_from_camera: [[f64; 4]; 4],
}

/// What differs from pose to pose: the camera's pose, and the objects that were put elsewhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Setting {
    pub(crate) camera: Pose,
    pub(crate) moved: Vec<(usize, Pose)>,
}

/// Rays from the camera into the scene in one setting.
pub(crate) struct Tracer<'a> {
    model: &'a CameraModel,
    ambient: f64,
    camera: RigidFrame,
    bodies: Vec<Body<'a>>,
}

struct Body<'a> {
    object: &'a Object,
    frame: RigidFrame,
    bounding_radius_m: f64,
}

/// A visible point.
struct Seen<'a> {
    object: &'a Object,
    distance_m: f64,
    cos_incidence: f64,
    place_m: [f64; 2],
}

impl<'a> Tracer<'a> {
    pub(crate) fn new(model: &'a CameraModel, scene: &'a Scene, setting: &Setting) -> Self {
        let bodies = scene.objects.iter().enumerate().map(|(index, object)| {
            let moved = setting.moved.iter().find(|(moved, _)| *moved == index);
            let frame = moved.map_or_else(|| object.pose(), |(_, pose)| *pose).frame();
            Body { object, frame, bounding_radius_m: object.form.bounding_radius_m() }
        });
        Self { model, ambient: scene.ambient, camera: setting.camera.frame(), bodies: bodies.collect() }
    }

    pub(crate) fn view(&self) -> View {
        View {
            pixels: Plane::from_fn(self.model.shape(), |row, column| self.pixel(row, column)),
            world_from_camera: self.camera.matrix(),
        }
    }

    /// Largest mean charge per integration time of any bin in the window at the image's centre, electrons
    /// per µs.
    pub(crate) fn largest_rate_in_the_window(&self, side: usize) -> f64 {
        let shape: Shape = self.model.shape();
        let pixels = Window::centred(shape, side).indices(shape);
        pixels
            .flat_map(|index| self.pixel(index / shape.width, index % shape.width).rates)
            .fold(0.0, f64::max)
    }

    fn pixel(&self, row: usize, column: usize) -> PixelView {
        let (row, column) = (row as f64, column as f64);
        let lens = self.model.lens_factor_at(row, column);
        let Some(seen) = self.nearest(row, column) else { return self.nothing(lens) };
        let surface = seen.object.texture.at(seen.place_m, seen.object.target);
        let highlight = seen
            .object
            .highlight
            .map_or(0.0, |highlight| highlight.strength * libm::pow(seen.cos_incidence, highlight.exponent));
        let radiance = surface.reflectivity * seen.cos_incidence + highlight;
        let return_factor = radiance * self.model.illumination_profile_at(row, column);
        let ambient = self.ambient * surface.reflectivity * lens;
        let light = self.model.light(return_factor, ambient, seen.distance_m);
        PixelView {
            rates: self.model.bin_rates_electrons_per_us(light),
            amplitude_rate: self.model.amplitude_rate_electrons_per_us(light),
            distance_m: seen.distance_m as f32,
            reflectivity: surface.reflectivity as f32,
            cos_incidence: seen.cos_incidence as f32,
            return_factor: return_factor as f32,
            specular_fraction: if radiance > 0.0 { (highlight / radiance) as f32 } else { 0.0 },
            target: surface.target,
        }
    }

    fn nothing(&self, lens: f64) -> PixelView {
        PixelView {
            rates: [self.model.radiometric_electrons_per_us * self.ambient * lens; 4],
            amplitude_rate: 0.0,
            distance_m: f32::NAN,
            reflectivity: f32::NAN,
            cos_incidence: f32::NAN,
            return_factor: f32::NAN,
            specular_fraction: f32::NAN,
            target: 0,
        }
    }

    fn nearest(&self, row: f64, column: f64) -> Option<Seen<'a>> {
        let origin = self.camera.center_m();
        let direction = self.camera.direction_to_world(normalized(self.model.intrinsics.ray(row, column)));
        let mut nearest: Option<Seen<'a>> = None;
        for body in self.bodies.iter().filter(|body| body.may_be_met(origin, direction)) {
            let local_direction = body.frame.direction_to_local(direction);
            let hit = body.object.form.hit(body.frame.point_to_local(origin), local_direction);
            let Some(hit) = hit else { continue };
            if nearest.as_ref().is_none_or(|seen| hit.distance < seen.distance_m) {
                nearest = Some(Seen {
                    object: body.object,
                    distance_m: hit.distance,
                    cos_incidence: dot(hit.normal, local_direction).abs().min(1.0),
                    place_m: hit.place_m,
                });
            }
        }
        nearest
    }
}

impl Body<'_> {
    /// False when the ray passes the ball around the object.
    fn may_be_met(&self, origin: Vector, direction: Vector) -> bool {
        let to_center = along(self.frame.center_m(), origin, -1.0);
        let forward = dot(to_center, direction);
        let beside_squared = dot(to_center, to_center) - forward * forward;
        // A little wider than the ball: rounding must not cut off an edge.
        beside_squared <= self.bounding_radius_m * self.bounding_radius_m * (1.0 + 1e-9) + 1e-12
    }
}
