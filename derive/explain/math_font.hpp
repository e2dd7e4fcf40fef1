// Where indices and exponents stand. A browser takes this from the table MATH of the first font of a formula, and fonts
// for text have none: indices then stand on the baseline. This font, of our own, has that table, with the proportions
// of TeX, and no letter but the space: the letters come from the next font of the list.
#pragma once

namespace cdot::derive {

// WOFF2, in base64.
constexpr const char* math_font =
    "d09GMgABAAAAAAGMAAsAAAAAA3QAAAFCAAEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAH4FyBmAANAocNgE2AiQDCAsGAAQgBWYHIBvD"
    "AhAeB3ZzTquwa7X4MJDi4b/9aPfNzKoB8YNn9+RJXLsl0SjWCIm0CbPToW1EpXiBq3P8jeOJBqIbJ9yXFQYd8Zo2eyIZcnE43egh"
    "6DwINeuFBBq902eeyTXdNd2uEAOIXtI1vCa24jqxgxiInfiF68RWjMcpPMQp0lLiAekOsYx0H0eJAdhDWoqHuEec7fwIHMVIRMRq"
    "rK0YOhKXeEbRj79vMRlAN4AcN+KcGoVhAKaVQaXK1f/x5MpDgOhNUIGEjG5ZoFtRoSgC1f//2fj/ewEggYJAQQ2ggKA0tdQ0jzzn"
    "HBAIPjz7e03b5K/1kfvg5FAlI0ezLIFgZ1R8wcY4JwAAKb4Q8xFIigAJAADFWAFCAwIkdRpkURqETu2wSatBszbuOfgYp2vWxs2y"
    "0R4HVeZb56Ctlthki0N2Wme/zAAA";

}  // namespace cdot::derive
