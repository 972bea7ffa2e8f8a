use std::str::FromStr;

use dorsal::allocentric_qsr::GroundPose;

/// A pose as people write it: `X,Z,HEADING` in metres and degrees to the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseArgument(pub(crate) GroundPose);

/// One standard error of a pose, `METRES,DEG`, in metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseError {
    pub(crate) position_m: f64,
    pub(crate) heading_rad: f64,
}

impl FromStr for PoseArgument {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [x_m, z_m, heading_deg] =
            numbers(text).ok_or("a pose is three numbers, X,Z,HEADING: metres, metres, degrees")?;
        GroundPose::new(x_m, z_m, heading_deg.to_radians())
            .map(Self)
            .map_err(|error| error.to_string())
    }
}

impl FromStr for PoseError {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let why = "the error of a pose is two numbers that are not negative, METRES,DEG";
        let [position_m, heading_deg] = numbers(text).ok_or(why)?;
        if position_m < 0.0 || heading_deg < 0.0 {
            return Err(why.to_owned());
        }
        Ok(Self {
            position_m,
            heading_rad: heading_deg.to_radians(),
        })
    }
}

/// So many finite numbers, joined by commas.
fn numbers<const COUNT: usize>(text: &str) -> Option<[f64; COUNT]> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|number| number.trim().parse().ok().filter(|n: &f64| n.is_finite()))
        .collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_metres_and_degrees() {
        let PoseArgument(pose) = "0.5,-1,90".parse().unwrap();
        assert_eq!((pose.x_m(), pose.z_m()), (0.5, -1.0));
        assert!((pose.heading_rad() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
        for bad in ["", "1,2", "1,2,3,4", "1,2,nan", "1,2,x", "1e9,0,0"] {
            assert!(bad.parse::<PoseArgument>().is_err(), "{bad}");
        }
        assert!("0.1,-1".parse::<PoseError>().is_err());
    }
}
