//! A warning: what it is about, and its words.

/// What a warning is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WarningKind {
    /// Skin or product has a size that no hand or product has: it is in another unit.
    Size,
    /// The press goes the other way than the product stands.
    Direction,
    /// The depth is more than tissue or part can give.
    Depth,
    /// The shear modulus is none of tissue.
    Modulus,
    /// The mesh is too coarse for the contact.
    CoarseMesh,
    /// The contact reaches where the skin is cut, held or masked.
    Cut,
    /// The response is used beyond what it is right for.
    ResponseRange,
    /// Few vertices may touch.
    Mask,
    /// Skin and product still overlap, or are pulled, or went through each other.
    Penetration,
    /// A refinement or a search ended short of its target, or the coarse mesh of a body does.
    Refinement,
}

impl WarningKind {
    /// The word for it.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Size => "size",
            Self::Direction => "direction",
            Self::Depth => "depth",
            Self::Modulus => "modulus",
            Self::CoarseMesh => "coarse_mesh",
            Self::Cut => "cut",
            Self::ResponseRange => "response_range",
            Self::Mask => "mask",
            Self::Penetration => "penetration",
            Self::Refinement => "refinement",
        }
    }
}

/// What the user should know of a contact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// What it is about.
    pub kind: WarningKind,
    /// The number found, what is usual, and what to do, in a sentence.
    pub message: String,
}
