/** @file What the records of the page hold. No code: the comments of the scripts name these types,
 * and the classes View, Player, Selection, LabelList, Painter of the files so called.
 *
 * Parameters that mean the same in all scripts: `pen` draws on a canvas; `painter` collects what is drawn by depth;
 * `view` is the View, `poses` the Pose of each body, `data` the CaseData of the load case that is shown, `colours` its
 * Colours, `labels` a LabelList. Numbers are SI unless a unit is named; NaN stands for open, that is, statically
 * indeterminate; Infinity for unbounded. A body is its number in `scene.bodies`, -1 is the ground.
 */

/**
 * @typedef {number[]} Vector three numbers
 * @typedef {[number, boolean, number, boolean]} Style how a number is written: decimals; whether with an exponent; the
 *   size up to which it is rounding, written as 0; whether any digit is known
 */

/**
 * @typedef {object} Shown How a quantity is written.
 * @property {string} unit in which it is written
 * @property {number} size the number in `unit` is so many times the number in SI
 * @property {Style} style of its digits
 */

/**
 * @typedef {object} CaseData One load case, as moving_page.py writes it. A packed column holds numbers of all frames.
 * @property {string} title of the spec
 * @property {string} case its name; "" for the spec itself
 * @property {string} version of heun
 * @property {string} file of the spec
 * @property {[string, string][]} about label and text of the lines at the foot
 * @property {string[]} notes on the run
 * @property {number} alerts how many of the notes are warnings
 * @property {number} count of frames
 * @property {Float64Array} time of each frame [s]
 * @property {number|null} horizon the instant up to which the motion is known [s]; null: its end
 * @property {number} worst the frame of the greatest load
 * @property {{frame: number, time: number, words: string}[]} marks impacts and events
 * @property {[string, number]} length the unit of lengths, and how many of it a metre has
 * @property {Scene} scene what is drawn
 * @property {ActingLoad[]} acting forces and moments on bodies
 * @property {Block[]} blocks the tables of all frames
 * @property {{number: number, frame: number, words: string, blocks: Block[]}[]} impulses the tables of impacts
 * @property {PageSection[]} sections with their section forces
 * @property {{heading: string, note: string}} cutting the head of the tables of sections
 * @property {Vector|null} foundation the point about which the moment on the ground counts [m]
 * @property {Map<string, Row>} [rows] of all tables by path; made by `prepareCase`
 */

/**
 * @typedef {object} Block A table.
 * @property {string} heading above it
 * @property {string} note its signs and axes
 * @property {string} kind joints, sections or another kind; the tabs choose by it
 * @property {string} missing what is written for NaN
 * @property {{name: string, note: string, rows: Row[]}[]} groups the rows of each object
 * @property {string[]} notes below the table
 */

/**
 * @typedef {object} RowParts A quantity: one number, or the components of a vector.
 * @property {string} path as in --measure
 * @property {string} label short name
 * @property {string} caption the label with the name of its object
 * @property {{name: string, caption: string, values: Float64Array}[]} parts its components
 * @property {boolean} sized whether its magnitude is shown too
 * @property {boolean} fixed whether it has one frame only, as in an impact
 * @typedef {Shown & RowParts} Row
 */

/**
 * @typedef {Shown & {path: string, label: string, caption: string, values: Float64Array}} SectionLoad A section force
 *   or stress; its values of all cuts of a frame, then those of the next frame.
 */

/**
 * @typedef {object} PageSection A section plane, or a run of cuts along a bar.
 * @property {string} name in the spec
 * @property {number} body that is cut
 * @property {string} note on its axes
 * @property {Vector[]} cuts a point of each cut, body axes [m]
 * @property {number[]|null} s the position of each cut along the bar [m]; null: a single plane
 * @property {string[]} side "before" or "beyond" a load at a cut, or ""
 * @property {Vector} normal body axes
 * @property {Vector} first axis e1, body axes
 * @property {Vector} second axis e2, body axes
 * @property {SectionLoad[]} loads section forces and stresses
 */

/**
 * @typedef {object} LoadVectors A force or moment on a body at all frames.
 * @property {string} name in the spec
 * @property {string} caption name that readers see
 * @property {"force"|"moment"} what which of the two
 * @property {Float64Array} at points of action, three numbers a frame [m]
 * @property {Float64Array} forces vectors, three numbers a frame
 * @typedef {Shown & LoadVectors} ActingLoad
 */

/**
 * @typedef {object} Scene Bodies and symbols, as geometry.py writes them.
 * @property {Body[]} bodies with their poses
 * @property {number[][][]} topologies the faces of surfaces; equal surfaces share them
 * @property {Joint[]} joints with their points and axes
 * @property {Line[]} lines springs and other loads between two points
 * @property {Float64Array[]} paths lines on the ground, three numbers a point [m]
 * @property {{body: number, strands: Float64Array}[]} belts ends of the strands, six numbers each, axes of the body
 *   that carries the pulleys
 * @property {Rope[]} ropes with their pulleys
 * @property {Mark[]} marks stops, latches and others
 * @property {{joint: number, symbols: string[], slides: boolean}[]} acting loads in joints: the symbols seen along the
 *   axis and against it; whether they stand along it
 * @property {Record<string, SymbolPart[]>} symbols by name
 * @property {{name: string, at: Vector}[]} ground its points [m]
 * @property {Vector} gravity [m/s²]
 * @property {{name: string, caption: string, row: string, at: Float64Array, forces: Float64Array|null}[]} pulls forces
 *   of couplings on bodies: the path of the row that holds them, points of action; vectors where no row has them
 * @property {Vector|null} normal of the plane of motion
 * @property {Vector} center of a box that holds the machine at all frames [m]
 * @property {Vector} half edges of that box [m]
 * @property {number} radius of a ball that holds the machine [m]
 * @property {Vector[]} [cloud] points that the view must show [m]; made by `prepareView`
 * @property {(toward: Vector) => number} [cover] how much large bodies hide the joints; made by `prepareView`
 */

/**
 * @typedef {object} Body
 * @property {string} name in the spec
 * @property {string} caption name that readers see
 * @property {Float64Array} places of its origin, three numbers a frame [m]
 * @property {Float64Array} attitudes unit quaternions w, x, y, z, four numbers a frame
 * @property {Surface[]} surfaces of its shapes
 * @property {Float64Array[]} bars polylines between its points, body axes [m]
 * @property {Float64Array[]} lines other lines on it, body axes [m]
 * @property {{name: string, at: Vector}[]} points body axes [m]
 */

/**
 * @typedef {object} Surface A polyhedron, or a sphere; body axes [m].
 * @property {Float64Array} [corners] three numbers each
 * @property {number[][]} [faces] the numbers of the corners of each face, counter-clockwise seen from outside
 * @property {{center: Vector, radius: number}} [ball] a sphere
 */

/**
 * @typedef {object} TwoPoints
 * @property {string} name in the spec
 * @property {string} kind which symbol is drawn
 * @property {number} a body
 * @property {Vector} p point of body a [m]
 * @property {number} b body
 * @property {Vector} q point of body b [m]
 * @typedef {TwoPoints} Line
 * @typedef {TwoPoints & {caption: string, axis: Vector, rope: boolean}} Joint its axis in the axes of body a; whether
 *   it is a rope, which only pulls
 */

/**
 * @typedef {object} Rope
 * @property {number} count of its straight spans
 * @property {Float64Array} ends of the spans, six numbers each, all spans of a frame after each other [m]
 * @property {{before: number, body: number, center: Vector, along: number, axis: Vector}[]} arcs on pulleys: the number
 *   of the span before; the centre on `body`; the axis of the pulley in the axes of the body `along`
 */

/**
 * @typedef {object} Mark A symbol of a stop, latch or the like; one that never moves is stored for frame 0 alone.
 * @property {string} symbol which of `symbols` is drawn
 * @property {string} name in the spec
 * @property {Float64Array} places three numbers a frame [m]
 * @property {Float64Array} ways its directions, three numbers a frame
 */

/**
 * @typedef {{points: [number, number][], closed: boolean, fill: string}} SymbolPart a polyline or polygon [pixels]
 * @typedef {{place: Vector, R: number[]}} Pose the origin of a body [m], and its rotation matrix row by row
 * @typedef {{frame: number, share: number}} Instant a frame, and how far the motion is on the way to the next, 0 to 1
 */

/**
 * @typedef {object} Arrow A force or moment over the frames.
 * @property {Row} row its components, path, unit and style
 * @property {(poses: Pose[], frame: number) => Vector|null} at its point of action, world axes [m]
 * @property {string} name of what it acts on
 * @property {(poses: Pose[], frame: number) => Vector} [vector] where the row has one component alone
 */

/**
 * @typedef {object} ArrowChoice A set of arrows that the user can choose.
 * @property {string} key by which it is chosen
 * @property {string} label short name
 * @property {Arrow[]} rows its arrows
 * @property {number} [frame] the only one at which an impulse acts
 * @property {boolean} [joints] whether the arrows name the joints
 */

/**
 * @typedef {object} TimeHistory A number over the frames.
 * @property {string} path of the number, as in --measure
 * @property {string} label what it is called
 * @property {string} unit in which it is shown
 * @property {Style} style of its digits
 * @property {number} size the number in `unit` is so many times the number in SI
 * @property {Float64Array} low in `unit`
 * @property {Float64Array} high the same array, but for a run of cuts: least and greatest of these
 */

/**
 * @typedef {{label: string, unit: string, values: Float64Array}} Axis over which a curve is drawn: time, or an angle
 * @typedef {{run: number, frame: number, value: number, x: number}} Extreme of all cases: where it is, and how large
 */

/**
 * @typedef {object} Envelope Of a curve over the load cases.
 * @property {Float64Array} values of the axis, ascending
 * @property {Float64Array} low least of all cases there
 * @property {Float64Array} high greatest of all cases there
 * @property {Extreme} least the lowest value of all
 * @property {Extreme} greatest the highest value of all
 * @property {string[]} names of the cases
 */

/**
 * @typedef {object} DrawOptions What is drawn of the machine, and how.
 * @property {number} frame that is drawn
 * @property {number} share of the way to the next frame, 0 to 1
 * @property {boolean} names whether names are written
 * @property {boolean} values whether the numbers of arrows and diagrams are written
 * @property {boolean} paths whether the paths of joints are drawn
 * @property {number} opacity of bodies, 0 to 1
 * @property {number} size factor of the length of arrows
 * @property {ArrowChoice|null} choice which arrows
 * @property {{section: PageSection, force: SectionLoad, cut: number}|null} load which section load
 */

/**
 * @typedef {Record<string, string> & {dark: boolean}} Colours of the style sheet by name; whether the page is dark
 */

/**
 * @typedef {object} PreviousCase What a load case leaves to the next one that is shown; none of it at first.
 * @property {View} [view] how the user looked
 * @property {Player} [player] with its speed
 * @property {Selection} [selection] what the user chose
 * @property {{label: string, value: number}} [place] where the run stood: on which axis, at which value
 * @property {string} [tab] which table was shown
 * @property {boolean} [playing] whether the machine played
 */
