"""glTF's opaque surface for Mitsuba 3, for references only.

    f = (1 - c F_c(wo)) (1 - c F_c(wi)) [(1 - metallic) (N base / pi + F_d S) + metallic F_m S] + c F_c S_c

S and S_c: GGX, separable Smith, alpha = roughness squared. F_d, F_c: Schlick from 0.04 at the half vector; F_m from the
base colour. N = (1 - F_d(wo)) (1 - F_d(wi)) / (1 - mean F_d), mean F_d = 0.04 + 0.96 / 21. Both sides scatter alike.
"""

import drjit as dr
import mitsuba as mi

F0 = 0.04


def schlick(f0: object, cosine: object) -> object:
    return f0 + (1 - f0) * dr.clip(1 - cosine, 0, 1) ** 5


class GltfSurface(mi.BSDF):
    """Parameters by the names of glTF's factors."""

    def __init__(self, props: mi.Properties) -> None:
        mi.BSDF.__init__(self, props)
        self.base_color = props["base_color"]
        self.metallic = props.get("metallic", 0.0)
        self.coat = props.get("clearcoat", 0.0)
        self.microfacets = self.ggx(props["roughness"])
        self.coat_microfacets = self.ggx(props.get("clearcoat_roughness", 0.1))
        both_sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        self.m_components = [mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection | both_sides]
        self.m_flags = self.m_components[0]

    @staticmethod
    def ggx(roughness: float) -> mi.MicrofacetDistribution:
        return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, max(roughness**2, 1e-4))

    def sample(self, ctx, si, sample1, sample2, active=True):
        wo_side = dr.sign(si.wi.z)
        o = si.wi * wo_side
        diffuse, specular, _ = self.shares(o)
        m, _ = self.microfacets.sample(o, sample2)
        m_coat, _ = self.coat_microfacets.sample(o, sample2)
        normal = dr.select(sample1 < diffuse + specular, m, m_coat)
        mirrored = 2 * dr.dot(o, normal) * normal - o
        i = dr.select(sample1 < diffuse, mi.warp.square_to_cosine_hemisphere(sample2), mirrored)
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = i * wo_side
        bs.eta = 1.0
        bs.sampled_type = mi.UInt32(+self.m_flags)
        bs.sampled_component = 0
        value, bs.pdf = self.eval_pdf(ctx, si, bs.wo, active)
        return bs, dr.select(bs.pdf > 0, value / bs.pdf, 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        side = dr.sign(si.wi.z)
        o, i = si.wi * side, wo * side
        active &= (o.z > 0) & (i.z > 0)
        m = dr.normalize(o + i)
        cosine = dr.dot(o, m)
        shape = self.microfacets.eval(m) * self.microfacets.G(o, i, m) / (4 * o.z * i.z)
        coat_shape = self.coat_microfacets.eval(m) * self.coat_microfacets.G(o, i, m) / (4 * o.z * i.z)
        matt = (1 - schlick(F0, o.z)) * (1 - schlick(F0, i.z)) / (1 - (F0 + (1 - F0) / 21))
        base = self.base_color.eval(si, active)
        dielectric = base * (matt / dr.pi) + schlick(F0, cosine) * shape
        metal = schlick(base, cosine) * shape
        coat_o, coat_i = self.coat * schlick(F0, o.z), self.coat * schlick(F0, i.z)
        below = (1 - self.metallic) * dielectric + self.metallic * metal
        f = (1 - coat_o) * (1 - coat_i) * below + self.coat * schlick(F0, cosine) * coat_shape
        diffuse, specular, coat = self.shares(o)
        pdf = diffuse * i.z / dr.pi
        pdf += specular * self.microfacets.pdf(o, m) / (4 * cosine)
        pdf += coat * self.coat_microfacets.pdf(o, m) / (4 * cosine)
        return dr.select(active, f * i.z, 0), dr.select(active, pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def shares(self, o: mi.Vector3f) -> tuple:
        """How often the matt base, its microfacets and those of the coat are sampled from `o`."""
        coat = 0.5 * self.coat * dr.sqrt(schlick(F0, o.z))
        diffuse = (1 - coat) * (1 - self.metallic) * 0.7
        return diffuse, 1 - coat - diffuse, coat

    def to_string(self) -> str:
        return "GltfSurface[]"


mi.register_bsdf("gltf_surface", GltfSurface)
