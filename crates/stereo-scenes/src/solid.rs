use crate::{shape::Shape, vector::Vector};

/// A [`Shape`] made ready for rays: its own axes, half sizes and centre.
#[derive(Clone, Debug)]
pub(crate) struct Solid {
    /// Centre in the room.
    pub(crate) centre: Vector,
    /// The solid's own x, y and z in the room: orthonormal.
    axes: [Vector; 3],
    /// Half of its extent along its own axes.
    half: Vector,
    form: Form,
}

#[derive(Clone, Copy, Debug)]
enum Form {
    Box,
    Sphere,
    Cylinder,
    /// Spans x and y of its own axes; z is its normal.
    Rectangle,
}

impl Solid {
    pub(crate) fn new(shape: &Shape) -> Self {
        match *shape {
            Shape::Box {
                base_m,
                size_m: [width, depth, height],
                turn_deg,
            } => Self {
                centre: Vector::from(base_m) + Vector::new(0.0, 0.0, height / 2.0),
                axes: turned(turn_deg),
                half: Vector::new(width, depth, height) * 0.5,
                form: Form::Box,
            },
            Shape::Sphere { centre_m, radius_m } => Self {
                centre: centre_m.into(),
                axes: turned(0.0),
                half: Vector::new(radius_m, radius_m, radius_m),
                form: Form::Sphere,
            },
            Shape::Cylinder {
                base_m,
                radius_m,
                height_m,
            } => Self {
                centre: Vector::from(base_m) + Vector::new(0.0, 0.0, height_m / 2.0),
                axes: turned(0.0),
                half: Vector::new(radius_m, radius_m, height_m / 2.0),
                form: Form::Cylinder,
            },
            Shape::Rectangle {
                centre_m,
                size_m: [width, height],
                turn_deg,
                lean_deg,
            } => {
                let [across, away, up] = turned(turn_deg);
                let (sin, cos) = lean_deg.to_radians().sin_cos();
                Self {
                    centre: centre_m.into(),
                    axes: [across, up * cos + away * sin, up * sin - away * cos],
                    half: Vector::new(width / 2.0, height / 2.0, 0.0),
                    form: Form::Rectangle,
                }
            }
        }
    }

    /// Radius of the sphere about the centre that holds the solid.
    pub(crate) fn bounding_radius(&self) -> f64 {
        match self.form {
            Form::Sphere => self.half.x,
            Form::Cylinder => self.half.x.hypot(self.half.z),
            Form::Box | Form::Rectangle => self.half.length(),
        }
    }

    /// Half of the extent along the axes of the room.
    pub(crate) fn half_extent(&self) -> Vector {
        match self.form {
            // Round about the vertical, so that the turn does not count.
            Form::Sphere | Form::Cylinder => self.half,
            Form::Box | Form::Rectangle => {
                let [a, b, c] = self.axes;
                let reach = |x: f64, y: f64, z: f64| {
                    (x * self.half.x).abs() + (y * self.half.y).abs() + (z * self.half.z).abs()
                };
                Vector::new(
                    reach(a.x, b.x, c.x),
                    reach(a.y, b.y, c.y),
                    reach(a.z, b.z, c.z),
                )
            }
        }
    }

    /// A point of the room in the solid's own axes, from its centre.
    pub(crate) fn local(&self, point: Vector) -> Vector {
        self.local_direction(point - self.centre)
    }

    fn local_direction(&self, v: Vector) -> Vector {
        let [a, b, c] = self.axes;
        Vector::new(a.dot(v), b.dot(v), c.dot(v))
    }

    /// The unit normal, outwards, at a point of the surface given in the solid's own axes.
    ///
    /// The face is the one whose extent the point reaches furthest, so a point that lies off the
    /// surface by rounding still gets the normal of the face it belongs to.
    pub(crate) fn normal(&self, local: Vector) -> Vector {
        let [a, b, c] = self.axes;
        match self.form {
            Form::Rectangle => c,
            Form::Sphere => (a * local.x + b * local.y + c * local.z).unit(),
            Form::Cylinder => {
                let radial = local.x.hypot(local.y);
                if radial / self.half.x < local.z.abs() / self.half.z {
                    c * local.z.signum()
                } else {
                    (a * local.x + b * local.y).unit()
                }
            }
            Form::Box => {
                let (x, y, z) = (
                    local.x / self.half.x,
                    local.y / self.half.y,
                    local.z / self.half.z,
                );
                if x.abs() >= y.abs() && x.abs() >= z.abs() {
                    a * x.signum()
                } else if y.abs() >= z.abs() {
                    b * y.signum()
                } else {
                    c * z.signum()
                }
            }
        }
    }

    /// The smallest `t > 0` with `origin + t direction` on the surface.
    pub(crate) fn hit(&self, origin: Vector, direction: Vector) -> Option<f64> {
        let (o, d) = (self.local(origin), self.local_direction(direction));
        match self.form {
            Form::Box => first_ahead(
                slab(o.x, d.x, self.half.x).and(slab(o.y, d.y, self.half.y).and(slab(
                    o.z,
                    d.z,
                    self.half.z,
                ))),
            ),
            Form::Sphere => first_ahead(round(
                d.dot(d),
                o.dot(d),
                o.dot(o) - self.half.x * self.half.x,
            )),
            Form::Cylinder => first_ahead(
                round(
                    d.x * d.x + d.y * d.y,
                    o.x * d.x + o.y * d.y,
                    o.x * o.x + o.y * o.y - self.half.x * self.half.x,
                )
                .and(slab(o.z, d.z, self.half.z)),
            ),
            Form::Rectangle => {
                let t = -o.z / d.z;
                let inside =
                    (o.x + t * d.x).abs() <= self.half.x && (o.y + t * d.y).abs() <= self.half.y;
                (t > 0.0 && inside).then_some(t)
            }
        }
    }
}

/// The room's axes turned to the right about the vertical.
fn turned(turn_deg: f64) -> [Vector; 3] {
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    [
        Vector::new(cos, -sin, 0.0),
        Vector::new(sin, cos, 0.0),
        Vector::new(0.0, 0.0, 1.0),
    ]
}

/// The part of a ray inside a convex body: from the parameter of entry to that of exit.
#[derive(Clone, Copy)]
struct Span {
    enter: f64,
    exit: f64,
}

impl Span {
    const NOWHERE: Self = Self {
        enter: f64::INFINITY,
        exit: f64::NEG_INFINITY,
    };

    fn and(self, other: Self) -> Self {
        Self {
            enter: self.enter.max(other.enter),
            exit: self.exit.min(other.exit),
        }
    }
}

fn first_ahead(span: Span) -> Option<f64> {
    if span.enter > span.exit {
        None
    } else if span.enter > 0.0 {
        Some(span.enter)
    } else {
        (span.exit > 0.0).then_some(span.exit)
    }
}

/// Where `|o + t d| <= half`.
fn slab(o: f64, d: f64, half: f64) -> Span {
    if d == 0.0 {
        return if o.abs() <= half {
            Span {
                enter: f64::NEG_INFINITY,
                exit: f64::INFINITY,
            }
        } else {
            Span::NOWHERE
        };
    }
    let (a, b) = ((-half - o) / d, (half - o) / d);
    Span {
        enter: a.min(b),
        exit: a.max(b),
    }
}

/// Where `a t^2 + 2 b t + c <= 0`, for `a >= 0`.
fn round(a: f64, b: f64, c: f64) -> Span {
    if a == 0.0 {
        return if c <= 0.0 {
            Span {
                enter: f64::NEG_INFINITY,
                exit: f64::INFINITY,
            }
        } else {
            Span::NOWHERE
        };
    }
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return Span::NOWHERE;
    }
    let root = discriminant.sqrt();
    Span {
        enter: (-b - root) / a,
        exit: (-b + root) / a,
    }
}
