//! A request or an answer in one block of memory: the length of its JSON as four bytes, little-endian, the JSON, and the
//! byte strings one after another. The member `sizes` of the JSON says how long each of these is.

use serde_json::{Value, json};

/// A request that was taken apart.
#[derive(Debug, PartialEq)]
pub struct Message<'a> {
    /// Its JSON.
    pub json: Value,
    /// Its byte strings.
    pub blobs: Vec<&'a [u8]>,
}

impl<'a> Message<'a> {
    /// Takes `bytes` apart; `None` if they are no message.
    pub fn parse(bytes: &'a [u8]) -> Option<Self> {
        let (length, rest) = bytes.split_first_chunk::<4>()?;
        let (json, mut rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        let json: Value = serde_json::from_slice(json).ok()?;
        let mut blobs = Vec::new();
        for size in json["sizes"].as_array().into_iter().flatten() {
            let (blob, after) = rest.split_at_checked(usize::try_from(size.as_u64()?).ok()?)?;
            blobs.push(blob);
            rest = after;
        }
        Some(Self { json, blobs })
    }
}

/// The block of `json`, an object, and `blobs`.
pub fn block(mut json: Value, blobs: &[Vec<u8>]) -> Vec<u8> {
    json["sizes"] = json!(blobs.iter().map(Vec::len).collect::<Vec<_>>());
    let text = json.to_string();
    let mut bytes = (text.len() as u32).to_le_bytes().to_vec();
    bytes.reserve_exact(text.len() + blobs.iter().map(Vec::len).sum::<usize>());
    bytes.extend(text.as_bytes());
    blobs.iter().for_each(|blob| bytes.extend(blob));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_put_together_is_taken_apart() {
        let bytes = block(json!({ "op": "x" }), &[vec![1, 2], vec![], vec![3]]);
        let message = Message::parse(&bytes).unwrap();
        assert_eq!(message.json["op"], "x");
        assert_eq!(message.blobs, [&[1, 2][..], &[], &[3]]);
    }

    #[test]
    fn what_is_cut_off_is_no_message() {
        let bytes = block(json!({ "op": "x" }), &[vec![1, 2]]);
        assert!((0..bytes.len()).all(|n| Message::parse(&bytes[..n]).is_none()));
    }
}
