//! What parts of a package have in common.

use std::borrow::Cow;

use quick_xml::XmlVersion;
use quick_xml::events::BytesStart;
use quick_xml::events::attributes::Attribute;

pub(super) const MEND: &str = "export it again, or repair it where it was made";

/// The attribute of this name, with its prefix if it has one.
pub(super) fn value(tag: &BytesStart<'_>, key: &str) -> Option<String> {
    tag.attributes().flatten().find(|a| a.key.0 == key).as_ref().and_then(text)
}

/// What the attribute says.
pub(super) fn text(attribute: &Attribute<'_>) -> Option<String> {
    attribute.normalized_value(XmlVersion::Implicit1_0).ok().map(Cow::into_owned)
}
