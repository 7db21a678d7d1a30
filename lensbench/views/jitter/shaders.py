"""GLSL of the view: where a vertex appears for one point of the pupil, which fragments lie in a zone, and the sums of light.

All jit* uniforms that a vertex needs stand for the head's frame: wear frame axes, mm from the centre of rotation.
"""

CAMERA = """
uniform mat4 MCDCMatrix;
uniform mat4 MCVCMatrix;
"""

_COMMON = """
uniform vec2 jitPoint;    // of the pupil, unit disc
uniform vec2 jitShift;    // within the pixel, device coordinates
uniform mat3 jitToHead;   // camera's frame to head
uniform mat4 jitToDevice; // head to clip coordinates
void jitPlace(vec3 direction, float reach) {
  gl_Position = jitToDevice * vec4(reach * normalize(direction), 1.0);
  gl_Position.xy += jitShift * gl_Position.w;
}
"""

# A triangle is not drawn that lies wholly beyond one of the sides jitAbout, or wholly within all of jitWithin.
EXTENSION = "//VTK::System::Dec\n#extension GL_ARB_cull_distance : enable\n"
_CULL = """
uniform float jitAbout[21];  // inward normals of seven sides, head's frame; zeros: no side
uniform float jitWithin[39]; // of thirteen
#ifdef GL_ARB_cull_distance
out float gl_CullDistance[8];
#define jitCulled gl_CullDistance
#else
float jitCulled[8];
#endif
void jitCull(vec3 direction) {
  for (int i = 0; i < 7; ++i)
    jitCulled[i] = dot(direction, vec3(jitAbout[3 * i], jitAbout[3 * i + 1], jitAbout[3 * i + 2]));
  float within = 1e30;
  for (int i = 0; i < 13; ++i)
    within = min(within, dot(direction, vec3(jitWithin[3 * i], jitWithin[3 * i + 1], jitWithin[3 * i + 2])));
  jitCulled[7] = -within;
}
"""

FIELD = (
    _COMMON
    + _CULL
    + """
uniform sampler2D jitField; // the atlas: five tiles one above the other
uniform vec4 jitGrid;       // first u, first v, 1 / step, z of the plane from which depth counts
uniform vec2 jitCount;      // of gazes along u and v
uniform vec3 jitRefraction; // xx, xy, yy, 1/mm
uniform vec4 jitEye;        // pupil radius, accommodation (amplitude, or in use), rule, 1/mm and mm

struct jitCell { ivec2 at; vec2 part; };

jitCell jitFind(vec2 uv) {
  vec2 place = (uv - jitGrid.xy) * jitGrid.z;
  vec2 corner = clamp(floor(place), vec2(0.0), jitCount - 2.0);
  return jitCell(ivec2(corner), place - corner);
}

vec4 jitFetch(int tile, ivec2 at) { return texelFetch(jitField, at + ivec2(0, tile * int(jitCount.y)), 0); }

mat2 jitMatrix(int tile, jitCell cell) {
  vec2 f = clamp(cell.part, 0.0, 1.0);
  vec4 low = mix(jitFetch(tile, cell.at), jitFetch(tile, cell.at + ivec2(1, 0)), f.x);
  vec4 high = mix(jitFetch(tile, cell.at + ivec2(0, 1)), jitFetch(tile, cell.at + ivec2(1, 1)), f.x);
  vec4 m = mix(low, high, f.y);
  return mat2(m.x, m.z, m.y, m.w);
}

// The chief ray at uv (origin, slope), and its change by u and v. Past the table's border the deviation stays as it is there.
vec4 jitRay(jitCell cell, out vec4 byU, out vec4 byV) {
  vec4 a = jitFetch(0, cell.at), b = jitFetch(0, cell.at + ivec2(1, 0));
  vec4 c = jitFetch(0, cell.at + ivec2(0, 1)), d = jitFetch(0, cell.at + ivec2(1, 1));
  vec2 f = clamp(cell.part, 0.0, 1.0), past = (cell.part - f) / jitGrid.z;
  byU = past.x == 0.0 ? mix(b - a, d - c, f.y) * jitGrid.z : vec4(jitGrid.w, 0.0, 1.0, 0.0);
  byV = past.y == 0.0 ? mix(c - a, d - b, f.x) * jitGrid.z : vec4(0.0, jitGrid.w, 0.0, 1.0);
  return mix(mix(a, b, f.x), mix(c, d, f.x), f.y) + vec4(jitGrid.w * past, past);
}

float jitSignedMeanAxis(mat2 m) {
  float e = (m[0][0] + m[1][1]) / 2.0, h = (m[0][1] - m[1][0]) / 2.0;
  return e < 0.0 ? -length(vec2(e, h)) : length(vec2(e, h));
}

// Accommodation in use, 1/mm. k: relaxed blur over the pupil radius; with the accommodation a it is k - a n.
float jitAccommodation(mat2 k, mat2 n) {
  int rule = int(jitEye.z);
  if (rule == 3) return jitEye.y;
  float wanted = 0.0;
  if (rule == 0) {
    mat2 error = inverse(n) * k;
    wanted = (error[0][0] + error[1][1]) / 2.0;
  } else if (rule == 1) {
    float square = dot(n[0], n[0]) + dot(n[1], n[1]);
    wanted = square == 0.0 ? 0.0 : (dot(k[0], n[0]) + dot(k[1], n[1])) / square;
  } else {
    float relaxed = jitSignedMeanAxis(k), tense = jitSignedMeanAxis(k - jitEye.y * n);
    wanted = relaxed == tense ? 0.0 : jitEye.y * relaxed / (relaxed - tense);
  }
  return clamp(wanted, 0.0, jitEye.y);
}

// Direction in which the point X appears: Newton's method for the chief ray through X, then a turn by -J^-1 M d. It takes
// two or three steps, towards the edge of a strong lens more; one that is drawn far off would hide the picture.
vec3 jitSeen(vec3 X) {
  float depth = X.z - jitGrid.w;
  if (X.z < 0.2 * length(X) || depth < 1.0) return X;
  vec2 uv = X.xy / X.z;
  mat2 turn = mat2(1.0);
  vec4 ray, byU, byV;
  jitCell cell;
  for (int step = 0; step < 8; ++step) {
    cell = jitFind(uv);
    ray = jitRay(cell, byU, byV);
    mat2 change = mat2(byU.xy / depth + byU.zw, byV.xy / depth + byV.zw);
    if (determinant(change) < 1e-4) break;
    turn = inverse(change);
    vec2 move = turn * (ray.xy / depth + ray.zw - X.xy / depth);
    float most = length(move);
    uv -= most > 0.5 ? move * (0.5 / most) : move;
    if (most < 1e-4) break;
  }
  mat2 refraction = mat2(jitRefraction.x, jitRefraction.y, jitRefraction.y, jitRefraction.z);
  mat2 n = jitMatrix(3, cell) + depth * jitMatrix(4, cell);
  mat2 k = jitMatrix(1, cell) + depth * jitMatrix(2, cell) + n * refraction;
  mat2 blur = jitEye.x * (k - jitAccommodation(k, n) * n);
  vec3 d = normalize(vec3(ray.zw, 1.0));
  vec2 across = blur * jitPoint;
  vec2 onPlane = across + d.xy * dot(d.xy, across) / (d.z * (1.0 + d.z));
  return vec3(uv - turn * onPlane / depth, 1.0);
}
"""
)

FIELD_PLACE = """
  vec3 jitX = jitToHead * (MCVCMatrix * vertexMC).xyz;
  vec3 jitApparent = jitSeen(jitX);
  jitPlace(jitApparent, length(jitX));
  jitCull(jitApparent);
"""

VERTICES = (
    _COMMON
    + _CULL
    + """
in vec3 jitGaze;
in vec3 jitSpreadX;
in vec3 jitSpreadY;
"""
)

VERTICES_PLACE = """
  float jitReach = length((MCVCMatrix * vertexMC).xyz);
  vec3 jitApparent = jitGaze + jitPoint.x * jitSpreadX + jitPoint.y * jitSpreadY;
  jitPlace(jitApparent, jitReach);
  jitCull(jitApparent);
"""

RIM = _COMMON
RIM_PLACE = """
  jitPlace(vertexMC.xyz, length(vertexMC.xyz));
  gl_Position.z = -0.999 * gl_Position.w;
"""
RIM_ZONE = """
uniform vec4 jitZone;
bool jitElsewhere() { return gl_FragCoord.x - jitZone.z < jitZone.y; }
"""

# A fragment is seen through the lens if it lies within the lens's edge and to the right of the split.
ZONE = """
uniform sampler2D jitEdge;   // tangent of the angle from the edge's axis, by the angle about it
uniform mat3 jitFromPixel;   // pixel to direction about the edge's axis
uniform vec4 jitZone;        // x: 1 inside, -1 outside; y: split, pixels; zw: shift, pixels
bool jitElsewhere() {
  vec3 w = jitFromPixel * vec3(gl_FragCoord.xy - jitZone.zw, 1.0);
  float steps = float(textureSize(jitEdge, 0).x);
  float place = fract(atan(w.y, w.x) / 6.283185307179586 + 1.0) * steps;
  float low = floor(place);
  float a = texelFetch(jitEdge, ivec2(int(mod(low, steps)), 0), 0).r;
  float b = texelFetch(jitEdge, ivec2(int(mod(low + 1.0, steps)), 0), 0).r;
  bool inside = w.z > 0.0 && length(w.xy) < mix(a, b, place - low) * w.z && gl_FragCoord.x - jitZone.z >= jitZone.y;
  return inside != (jitZone.x > 0.0);
}
"""
ZONE_COLOUR = """
  if (jitElsewhere()) discard;
"""

# The core of a zone: its triangles that lie wholly within all of jitWithin, and are drawn without a test of where they lie.
_CORE = """
out float jitDoubt;
"""
_CORE_PLACE = """
  jitDoubt = max(0.0, jitCulled[7]);
  jitCulled[7] = 1.0;
"""
_CORE_ZONE = """
in float jitDoubt;
bool jitElsewhere() { return jitDoubt > 0.0; }
"""

# What a zone declares, where it places a vertex, and which fragments it leaves out.
KINDS = {
    "atlas": (FIELD, FIELD_PLACE, ZONE),
    "atlas core": (FIELD + _CORE, FIELD_PLACE + _CORE_PLACE, _CORE_ZONE),
    "vertices": (VERTICES, VERTICES_PLACE, ZONE),
    "vertices core": (VERTICES + _CORE, VERTICES_PLACE + _CORE_PLACE, _CORE_ZONE),
    "rim": (RIM, RIM_PLACE, RIM_ZONE),
}

_QUAD = """//VTK::System::Dec
in vec2 texCoord;
uniform sampler2D jitSource;
uniform float jitExposure;
//VTK::Output::Dec
vec3 decode(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045))); }
vec3 encode(vec3 c) { return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308))); }
void main() {
  vec4 c = texelFetch(jitSource, ivec2(texCoord * vec2(textureSize(jitSource, 0))), 0);
  gl_FragData[0] = RESULT;
}
"""
ADD = _QUAD.replace("RESULT", "vec4(decode(c.rgb), 1.0)")
RESOLVE = _QUAD.replace("RESULT", "vec4(encode(clamp(c.rgb / c.a * jitExposure, 0.0, 1.0)), 1.0)")
