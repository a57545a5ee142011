// Shared definitions of the CL-gstHDC slip detector's modules: the sensor's layout, the
// quantisation of its features and the types passed between the stages.

package hd_pkg;

  parameter int unsigned NumPillars = 9;
  parameter int unsigned NumGraphs = 3;
  parameter int unsigned NumContexts = 4;
  parameter int unsigned NumClasses = 3;
  parameter int unsigned NumLevels = 21;

  // The item memory holds one vector per pillar, then one per graph.
  parameter int unsigned NumItems = NumPillars + NumGraphs;

  parameter int unsigned CentrePillar = 4;
  parameter int unsigned GraphSize = 4;
  // Complete graphs of pillars of the same height: corners, edges. The centre is the third graph.
  parameter int unsigned Corners[GraphSize] = '{0, 2, 6, 8};
  parameter int unsigned Edges[GraphSize] = '{1, 3, 5, 7};

  // Displacements are Q13.3: two's complement in steps of 1/8 mm.
  parameter int unsigned DispWidth = 16;
  typedef struct packed {
    logic signed [DispWidth-1:0] z;
    logic signed [DispWidth-1:0] y;
    logic signed [DispWidth-1:0] x;
  } disp_t;

  typedef logic [$clog2(NumLevels)-1:0] level_t;
  typedef logic [$clog2(NumContexts)-1:0] context_t;

  // Largest compression of each context except the last, in 1/8 mm: 0.75, 1 and 1.125 mm.
  parameter int unsigned ContextEnd[NumContexts-1] = '{6, 8, 9};

  // A quantised frame. `first`: a window starts here, and earlier frames are discarded.
  typedef struct packed {
    logic                    first;
    context_t                ctx;
    level_t [NumPillars-1:0] level;
  } frame_t;

  // Place of a slice in its frame. `full`: the frame is the last of a full window or a later one.
  typedef struct packed {
    logic valid;
    logic first;
    logic last;
    logic full;
  } slice_tag_t;

  // ClassNone: fewer frames than the window holds.
  typedef enum logic [1:0] {
    ClassNone      = 2'd0,
    ClassNonSlip   = 2'd1,
    ClassIncipient = 2'd2,
    ClassGross     = 2'd3
  } class_e;

  // Slice counters have one bit even for a single slice.
  function automatic int unsigned index_width(int unsigned count);
    return (count > 1) ? $clog2(count) : 1;
  endfunction

endpackage
