use crate::{gaze::Gaze, noise::mix, room::Room, solid::Solid, texture::Texture, vector::Vector};

/// A room made ready for the rays of one gaze.
///
/// Radiance is a function of the point of a surface alone, and never of the eye that sees it:
/// shading is Lambertian, and texture detail is chosen by the distance from the point midway
/// between the eyes. So a point looks the same to both eyes, which is what stereo assumes.
#[derive(Debug)]
pub(crate) struct Stage<'a> {
    bodies: Vec<Body<'a>>,
    walls: [&'a Texture; 6],
    size: Vector,
    lamp: Vector,
    viewer: Vector,
    /// Extent of a pixel at distance 1.
    pixel: f64,
}

#[derive(Debug)]
struct Body<'a> {
    solid: Solid,
    bounding_radius: f64,
    texture: &'a Texture,
    /// 0 for scenery.
    label: u16,
}

/// What a ray meets first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// The ray's parameter there.
    pub(crate) t: f64,
    pub(crate) surface: Surface,
}

/// A body by its number, or a wall by its number in [`Walls`](crate::Walls).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Surface {
    Body(usize),
    Wall(usize),
}

/// Light that comes from everywhere, as a share of the lamp's.
const AMBIENT: f64 = 0.55;

impl<'a> Stage<'a> {
    pub(crate) fn new(room: &'a Room, gaze: &Gaze) -> Self {
        let objects = room.names().map(|(label, _)| label.0.get());
        let scenery = std::iter::repeat(0);
        let bodies = (objects.zip(room.objects()))
            .chain(scenery.zip(room.scenery()))
            .map(|(label, thing)| {
                let solid = Solid::new(&thing.shape);
                Body {
                    bounding_radius: solid.bounding_radius(),
                    solid,
                    texture: &thing.texture,
                    label,
                }
            })
            .collect();
        Self {
            bodies,
            walls: room.walls().named().map(|(_, texture)| texture),
            size: room.size_m().into(),
            lamp: room.lamp_m().into(),
            viewer: gaze.position_m().into(),
            pixel: gaze.rig().intrinsics().left.focal_px.0.recip(),
        }
    }

    /// Whether a point lies strictly between the walls.
    pub(crate) fn holds(&self, point: Vector) -> bool {
        let between = |c: f64, end: f64| 0.0 < c && c < end;
        between(point.x, self.size.x)
            && between(point.y, self.size.y)
            && between(point.z, self.size.z)
    }

    /// The label of a surface; 0 for walls and scenery.
    pub(crate) fn label(&self, surface: Surface) -> u16 {
        match surface {
            Surface::Body(number) => self.bodies[number].label,
            Surface::Wall(_) => 0,
        }
    }

    /// All bodies, as candidates for [`Stage::first_hit`].
    pub(crate) fn everything(&self) -> Vec<usize> {
        (0..self.bodies.len()).collect()
    }

    /// The bodies that may be met by rays from `origin` within `half_angle_rad` of `axis`.
    pub(crate) fn in_cone(&self, origin: Vector, axis: Vector, half_angle_rad: f64) -> Vec<usize> {
        let axis = axis.unit();
        let meets = |body: &Body<'_>| {
            let to_centre = body.solid.centre - origin;
            let distance = to_centre.length();
            if distance <= body.bounding_radius {
                return true;
            }
            let off_axis = (axis.dot(to_centre) / distance).clamp(-1.0, 1.0).acos();
            off_axis <= half_angle_rad + (body.bounding_radius / distance).asin()
        };
        (0..self.bodies.len())
            .filter(|&number| meets(&self.bodies[number]))
            .collect()
    }

    /// What a ray meets first: one of the candidates, or a wall.
    pub(crate) fn first_hit(&self, origin: Vector, direction: Vector, among: &[usize]) -> Hit {
        let mut first = self.wall_hit(origin, direction);
        for &number in among {
            if let Some(t) = self.bodies[number].solid.hit(origin, direction)
                && t < first.t
            {
                first = Hit {
                    t,
                    surface: Surface::Body(number),
                };
            }
        }
        first
    }

    /// Where a ray from inside the room leaves it.
    fn wall_hit(&self, origin: Vector, direction: Vector) -> Hit {
        let exit = |o: f64, d: f64, end: f64, low: usize, high: usize| {
            if d < 0.0 {
                (-o / d, low)
            } else if d > 0.0 {
                ((end - o) / d, high)
            } else {
                (f64::INFINITY, low)
            }
        };
        let across = exit(origin.x, direction.x, self.size.x, 0, 1);
        let away = exit(origin.y, direction.y, self.size.y, 2, 3);
        let up = exit(origin.z, direction.z, self.size.z, 4, 5);
        let sooner = |a: (f64, usize), b: (f64, usize)| if b.0 < a.0 { b } else { a };
        let (t, wall) = sooner(sooner(across, away), up);
        Hit {
            t,
            surface: Surface::Wall(wall),
        }
    }

    /// The colour that both eyes see at a point of a surface.
    pub(crate) fn radiance(&self, point: Vector, surface: Surface) -> [f32; 3] {
        let (texture, paint_point, normal, number) = match surface {
            Surface::Body(number) => {
                let body = &self.bodies[number];
                let local = body.solid.local(point);
                (body.texture, local, body.solid.normal(local), number + 6)
            }
            Surface::Wall(wall) => (self.walls[wall], point, WALL_NORMALS[wall], wall),
        };
        let to_viewer = self.viewer - point;
        let distance = to_viewer.length();
        let facing = normal.dot(to_viewer) / distance;
        // The default takes two rays across a pixel, so a surface seen at a slant may shrink to
        // half before its texture must lose detail.
        let slant = (2.0 * facing.abs()).recip().max(1.0);
        let footprint_m = distance * self.pixel * slant;
        let [r, g, b] = texture.colour_at(paint_point, footprint_m as f32, mix(number as u32));

        let to_lamp = self.lamp - point;
        // A panel shows the viewer the face turned toward him.
        let lit = (normal.dot(to_lamp) * facing.signum() / to_lamp.length()).max(0.0);
        let light = (AMBIENT + (1.0 - AMBIENT) * lit) as f32;
        [light * r, light * g, light * b]
    }
}

/// The directions into the room, in the order of [`Walls`](crate::Walls).
const WALL_NORMALS: [Vector; 6] = [
    Vector::new(1.0, 0.0, 0.0),
    Vector::new(-1.0, 0.0, 0.0),
    Vector::new(0.0, 1.0, 0.0),
    Vector::new(0.0, -1.0, 0.0),
    Vector::new(0.0, 0.0, 1.0),
    Vector::new(0.0, 0.0, -1.0),
];
