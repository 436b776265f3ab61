//! Messages of ROS 2 as CDR has them: fields in the order of their definitions, without names.

use byteorder::{BigEndian, LittleEndian};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// `builtin_interfaces/Time` and `Duration`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Seconds.
    pub sec: i32,
    /// Nanoseconds, below 10⁹.
    pub nanosec: u32,
}

impl Time {
    /// `nanoseconds` since 1970; what does not fit is the latest time there is.
    pub fn from_ns(nanoseconds: u64) -> Self {
        let sec = i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX);
        Self { sec, nanosec: (nanoseconds % 1_000_000_000) as u32 }
    }
}

/// `std_msgs/Header`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Time of what the message holds.
    pub stamp: Time,
    /// Frame of its coordinates.
    pub frame_id: String,
}

/// `geometry_msgs/Point` and `Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Along the frame's x axis.
    pub x: f64,
    /// Along the frame's y axis.
    pub y: f64,
    /// Along the frame's z axis.
    pub z: f64,
}

/// `geometry_msgs/Quaternion`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// First imaginary part.
    pub x: f64,
    /// Second imaginary part.
    pub y: f64,
    /// Third imaginary part.
    pub z: f64,
    /// Real part.
    pub w: f64,
}

impl Quaternion {
    /// The turn by `yaw_rad` about the z axis.
    pub fn from_yaw(yaw_rad: f64) -> Self {
        Self { z: (yaw_rad / 2.0).sin(), w: (yaw_rad / 2.0).cos(), ..Self::default() }
    }
}

/// `geometry_msgs/Pose`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Where.
    pub position: Point,
    /// How it is turned.
    pub orientation: Quaternion,
}

/// `nav_msgs/MapMetaData`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapMetaData {
    /// When the map was loaded.
    pub map_load_time: Time,
    /// Side of a cell in meters.
    pub resolution: f32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Pose of the lower left corner.
    pub origin: Pose,
}

/// `nav_msgs/OccupancyGrid`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OccupancyGrid {
    /// Time and frame.
    pub header: Header,
    /// Size and place.
    pub info: MapMetaData,
    /// −1 unknown, else 0 to 100; row by row, the lowest first.
    pub data: Vec<i8>,
}

/// `std_msgs/ColorRGBA`, each from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Color {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// Opacity.
    pub a: f32,
}

/// `sensor_msgs/CompressedImage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// Time and frame.
    pub header: Header,
    /// What the bytes are.
    pub format: String,
    /// The bytes.
    pub data: Vec<u8>,
}

/// `visualization_msgs/MeshFile`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeshFile {
    /// Name of the file.
    pub filename: String,
    /// Its bytes.
    pub data: Vec<u8>,
}

/// `visualization_msgs/Marker`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// Time and frame.
    pub header: Header,
    /// Namespace: with [`Self::id`] the marker's name.
    pub ns: String,
    /// Number in the namespace.
    pub id: i32,
    /// Shape.
    pub kind: i32,
    /// 0 adds or changes, 3 deletes all.
    pub action: i32,
    /// Where.
    pub pose: Pose,
    /// Size in meters; what it means depends on the shape.
    pub scale: Point,
    /// Color of the whole marker.
    pub color: Color,
    /// How long it is shown; 0: until it is deleted.
    pub lifetime: Time,
    /// Whether it follows its frame.
    pub frame_locked: bool,
    /// Points of lists.
    pub points: Vec<Point>,
    /// A color for each point, or none.
    pub colors: Vec<Color>,
    /// Unused.
    pub texture_resource: String,
    /// Unused.
    pub texture: CompressedImage,
    /// Unused.
    pub uv_coordinates: Vec<[f32; 2]>,
    /// Text of text markers.
    pub text: String,
    /// Unused.
    pub mesh_resource: String,
    /// Unused.
    pub mesh_file: MeshFile,
    /// Unused.
    pub mesh_use_embedded_materials: bool,
}

/// `visualization_msgs/MarkerArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// The markers, in the order in which they are carried out.
    pub markers: Vec<Marker>,
}

/// `std_msgs/String`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Text {
    /// The text.
    pub data: String,
}

/// The bytes of a message: four that say that little-endian CDR follows, and that.
///
/// # Errors
/// What the encoder says; never for the messages here, unless one is larger than 4 GB.
pub fn to_cdr<T: Serialize>(message: &T) -> Result<Vec<u8>, cdr_encoding::Error> {
    let body = cdr_encoding::to_vec::<T, LittleEndian>(message)?;
    Ok([&[0, 1, 0, 0], body.as_slice()].concat())
}

/// The message in `bytes`, of either byte order; bytes behind it are padding.
///
/// # Errors
/// What is wrong with the bytes, in words.
pub fn from_cdr<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let Some(([kind_high, kind_low, _, _], body)) = bytes.split_first_chunk::<4>() else {
        return Err(format!("expected four bytes before the message, found {}", bytes.len()));
    };
    let message = match (kind_high, kind_low) {
        (0, 0) => cdr_encoding::from_bytes::<T, BigEndian>(body),
        (0, 1) => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        (high, low) => {
            return Err(format!("expected plain CDR, found the representation {high:02x}{low:02x}"));
        }
    };
    message.map(|(message, _)| message).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_byte_by_byte() {
        let header = Header { stamp: Time { sec: 1, nanosec: 2 }, frame_id: "map".to_owned() };
        let bytes = to_cdr(&header).unwrap();
        // The length of a text counts the zero at its end.
        assert_eq!(bytes, b"\0\x01\0\0\x01\0\0\0\x02\0\0\0\x04\0\0\0map\0");
        assert_eq!(from_cdr::<Header>(&bytes).unwrap(), header);
        let big = b"\0\0\0\0\0\0\0\x01\0\0\0\x02\0\0\0\x04map\0";
        assert_eq!(from_cdr::<Header>(big).unwrap(), header);
    }

    #[test]
    fn what_is_no_message_is_an_error() {
        for bytes in [
            &b""[..],
            b"\0\x01\0",
            b"\0\x01\0\0",
            b"\0\x07\0\0\0\0\0\0",
            b"\0\x01\0\0\x01\0\0\0\x02\0\0\0\xff\xff\xff\xffmap\0",
        ] {
            assert!(from_cdr::<Header>(bytes).is_err(), "{bytes:?}");
        }
        let cut = to_cdr(&OccupancyGrid { data: vec![0; 100], ..OccupancyGrid::default() }).unwrap();
        assert!(from_cdr::<OccupancyGrid>(&cut[..cut.len() - 1]).is_err());
    }

    #[test]
    fn times_of_nanoseconds() {
        assert_eq!(Time::from_ns(2_000_000_007), Time { sec: 2, nanosec: 7 });
        assert_eq!(Time::from_ns(u64::MAX).sec, i32::MAX);
    }
}
